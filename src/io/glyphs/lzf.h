/* lzf: decompresses LZF (Marc Lehmann's liblzf), the compression of PCD files. Internal to src/io/glyphs. */
#ifndef ISO_IO_GLYPHS_LZF_H
#define ISO_IO_GLYPHS_LZF_H

#include <stdbool.h>
#include <stddef.h>

/* Three bytes of compressed data stand for at most 264 bytes. */
enum { ISO_LZF_MOST_RATIO = 88 };

/* Decompresses `from_bytes` bytes into exactly `to_bytes` bytes. Returns false, with `to` undefined, if the
 * data is damaged or has another length. Never reads or writes outside the two ranges. Thread-safe. */
bool iso_lzf_decompress(const unsigned char *from, size_t from_bytes, unsigned char *to, size_t to_bytes);

#endif
