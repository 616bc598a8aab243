/* Sets of voxels, in memory and as runs. */
#include "sculpt/brush/voxel_set.h"

#include <stdlib.h>

#include "base/memory.h"

size_t iso_voxel_set_count(const iso_voxel_set *set) {
    return (size_t)set->dims[0] * (size_t)set->dims[1] * (size_t)set->dims[2];
}

iso_status iso_voxel_set_init(iso_voxel_set *set, iso_error *error) {
    const size_t count = iso_voxel_set_count(set);
    if (count > ISO_VOXEL_SET_MOST)
        return iso_fail(error, ISO_ERR_LIMIT, "%zu voxels to freeze: at most %d", count, ISO_VOXEL_SET_MOST);
    set->word = iso_alloc_zero((count + 63) / 64, sizeof *set->word);
    return set->word ? ISO_OK : iso_fail_memory(error, "voxels to freeze");
}

void iso_voxel_set_free(iso_voxel_set *set) {
    iso_free(set->word);
    set->word = NULL;
}

static bool bit_of(const iso_voxel_set *set, size_t i) {
    return set->word[i / 64] >> i % 64 & 1;
}

/* Returns where the run that begins at a voxel ends. */
static size_t end_of_run(const iso_voxel_set *set, size_t from, size_t count) {
    const bool in = bit_of(set, from);
    const uint64_t all = in ? UINT64_MAX : 0;
    size_t i = from + 1;
    while (i < count && (i % 64 || set->word[i / 64] != all) && bit_of(set, i) == in) i++;
    while (i % 64 == 0 && i + 64 <= count && set->word[i / 64] == all) i += 64;
    while (i < count && bit_of(set, i) == in) i++;
    return i;
}

uint8_t *iso_voxel_set_pack(const iso_voxel_set *set, size_t *size) {
    enum { LONGEST = 10 };
    const size_t count = iso_voxel_set_count(set);
    size_t room = 4096, used = 0, i = 0;
    uint8_t *bytes = malloc(room);
    if (bytes && count && bit_of(set, 0)) bytes[used++] = 0; /* no voxel before the first run */
    while (bytes && i < count) {
        const size_t end = end_of_run(set, i, count);
        if (used + LONGEST > room) {
            uint8_t *larger = realloc(bytes, room *= 2);
            if (!larger) free(bytes);
            bytes = larger;
            if (!bytes) break;
        }
        size_t run = end - i;
        for (; run > 127; run >>= 7) bytes[used++] = (uint8_t)(run | 128);
        bytes[used++] = (uint8_t)run;
        i = end;
    }
    *size = used;
    return bytes;
}

static void add_run(iso_voxel_set *set, size_t from, size_t to) {
    for (size_t i = from; i < to;)
        if (i % 64 == 0 && i + 64 <= to) {
            set->word[i / 64] = UINT64_MAX;
            i += 64;
        } else {
            set->word[i / 64] |= (uint64_t)1 << i % 64;
            i++;
        }
}

bool iso_voxel_set_unpack(const uint8_t *bytes, size_t size, iso_voxel_set *set) {
    const size_t count = iso_voxel_set_count(set);
    size_t at = 0;
    bool in = false;
    for (size_t i = 0; i < size; in = !in) {
        size_t run = 0;
        int shift = 0;
        do {
            if (shift > 28) return false;
            run |= (size_t)(bytes[i] & 127) << shift;
            shift += 7;
        } while (bytes[i++] & 128 && i < size);
        if (bytes[i - 1] & 128 || run > count - at) return false;
        if (in) add_run(set, at, at + run);
        at += run;
    }
    return at == count;
}
