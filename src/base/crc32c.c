/* Computes the Castagnoli checksum: with the processor's own instruction (SSE 4.2, which every machine with
 * AVX2 has), else eight bytes at a time with tables (Kounavis and Berry 2008, "Novel table lookup-based
 * algorithms for high-performance CRC generation"). */
#include "base/crc32c.h"

#include <pthread.h>
#include <string.h>

#include "base/cpu.h"

#if ISO_HAVE_X86
#include <nmmintrin.h>
#endif

enum { SLICES = 8, POLYNOMIAL = 0x82f63b78 /* in reversed bit order */ };

static uint32_t tables[SLICES][256];

/* tables[0] advances a checksum by one byte, tables[k] by this byte and k zero bytes after it. */
static void fill_tables(void) {
    for (uint32_t byte = 0; byte < 256; byte++) {
        uint32_t crc = byte;
        for (int bit = 0; bit < 8; bit++) crc = crc >> 1 ^ (crc & 1 ? (uint32_t)POLYNOMIAL : 0);
        tables[0][byte] = crc;
    }
    for (int slice = 1; slice < SLICES; slice++)
        for (int byte = 0; byte < 256; byte++) {
            const uint32_t before = tables[slice - 1][byte];
            tables[slice][byte] = before >> 8 ^ tables[0][before & 255];
        }
}

static uint32_t update_by_table(uint32_t crc, const uint8_t *bytes, size_t size) {
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, fill_tables);
    for (; size >= SLICES; bytes += SLICES, size -= SLICES) {
        uint32_t next = 0;
        for (int i = 0; i < SLICES; i++) {
            const uint32_t byte = bytes[i] ^ (i < 4 ? crc >> 8 * i & 255 : 0);
            next ^= tables[SLICES - 1 - i][byte];
        }
        crc = next;
    }
    for (; size > 0; bytes++, size--) crc = crc >> 8 ^ tables[0][(crc ^ *bytes) & 255];
    return crc;
}

#if ISO_HAVE_X86
__attribute__((target("sse4.2"))) static uint32_t update_by_instruction(uint32_t crc, const uint8_t *bytes,
                                                                        size_t size) {
    uint64_t wide = crc;
    for (; size >= 8; bytes += 8, size -= 8) {
        uint64_t eight;
        memcpy(&eight, bytes, sizeof eight);
        wide = _mm_crc32_u64(wide, eight);
    }
    crc = (uint32_t)wide;
    for (; size > 0; bytes++, size--) crc = _mm_crc32_u8(crc, *bytes);
    return crc;
}
#endif

uint32_t iso_crc32c(uint32_t crc, const void *bytes, size_t size) {
#if ISO_HAVE_X86
    if (iso_cpu_best() >= ISO_CPU_AVX2) return ~update_by_instruction(~crc, bytes, size);
#endif
    return ~update_by_table(~crc, bytes, size);
}
