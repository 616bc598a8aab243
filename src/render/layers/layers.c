/* layers: the memory of lists of fragments. Chunks are taken one after the other from blocks, which are kept
 * for later bands, because touching new pages takes longer than compositing. */
#include "render/layers/layers.h"

#include <math.h>

#include "base/memory.h"

enum { BLOCK_CHUNKS = 64 };

iso_status iso_layer_lists_reserve(iso_layer_lists *lists, int width, int rows, iso_error *error) {
    lists->width = width;
    lists->rows = rows;
    lists->row_groups = (width + ISO_LAYER_GROUP - 1) / ISO_LAYER_GROUP;
    lists->groups = iso_alloc((size_t)rows * (size_t)lists->row_groups * sizeof *lists->groups);
    if (!lists->groups)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the layers of %d rows of a picture", rows);
    return ISO_OK;
}

void iso_layer_lists_free(iso_layer_lists *lists) {
    for (size_t i = 0; i < lists->block_count; i++) iso_free(lists->blocks[i]);
    iso_free(lists->blocks);
    iso_free(lists->groups);
    *lists = (iso_layer_lists){.groups = NULL};
}

void iso_layer_lists_clear(iso_layer_lists *lists, int rows) {
    lists->rows = rows;
    lists->chunks = 0;
    lists->full = false;
    const size_t groups = (size_t)rows * (size_t)lists->row_groups;
    for (size_t i = 0; i < groups; i++) {
        lists->groups[i].first = NULL;
        for (int column = 0; column < ISO_LAYER_GROUP; column++) lists->groups[i].list[column].count = 0;
    }
}

/* Begins to list a surface at a sample that has fragments of other surfaces already. */
static void begin_list(iso_layer_list *list) {
    list->through = 1;
    list->last = -INFINITY;
    list->own = 0;
}

void iso_layer_lists_begin(iso_layer_lists *lists, const iso_layer_pass *pass) {
    lists->pass = *pass;
    const size_t groups = (size_t)lists->rows * (size_t)lists->row_groups;
    for (size_t i = 0; i < groups; i++) {
        iso_layer_group *group = &lists->groups[i];
        group->doubtful = 0;
        for (int column = 0; column < ISO_LAYER_GROUP; column++) begin_list(&group->list[column]);
    }
}

void iso_layer_lists_restart(iso_layer_lists *lists, int x, int row) {
    iso_layer_group *group = iso_layer_group_at(lists, x, row);
    const int column = x % ISO_LAYER_GROUP;
    iso_layer_list *list = &group->list[column];
    int kept = 0;
    for (int k = 0; k < list->count; k++) {
        const iso_packed_fragment *fragment = &iso_layer_at(group, k)[column];
        if (iso_fragment_unpack(fragment).surface != lists->pass.surface)
            iso_layer_at(group, kept++)[column] = *fragment;
    }
    list->count = kept;
    begin_list(list);
}

/* Appends a block of chunks. */
static bool add_block(iso_layer_lists *lists) {
    iso_layer_chunk **blocks = iso_alloc((lists->block_count + 1) * sizeof *blocks);
    if (!blocks) return false;
    blocks[lists->block_count] = iso_alloc(BLOCK_CHUNKS * sizeof **blocks);
    if (!blocks[lists->block_count]) {
        iso_free(blocks);
        return false;
    }
    if (lists->block_count) memcpy(blocks, lists->blocks, lists->block_count * sizeof *blocks);
    iso_free(lists->blocks);
    lists->blocks = blocks;
    lists->block_count++;
    return true;
}

iso_layer_chunk *iso_layer_chunk_after(iso_layer_lists *lists, iso_layer_chunk **link) {
    const bool allowed = !lists->most_chunks || lists->chunks < lists->most_chunks;
    if (!allowed || (lists->chunks == lists->block_count * BLOCK_CHUNKS && !add_block(lists))) {
        lists->full = true;
        return NULL;
    }
    iso_layer_chunk *chunk = &lists->blocks[lists->chunks / BLOCK_CHUNKS][lists->chunks % BLOCK_CHUNKS];
    lists->chunks++;
    chunk->next = NULL;
    *link = chunk;
    return chunk;
}
