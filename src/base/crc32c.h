/* crc32c: computes the Castagnoli checksum (RFC 3720, appendix B.4). */
#ifndef ISO_BASE_CRC32C_H
#define ISO_BASE_CRC32C_H

#include <stddef.h>
#include <stdint.h>

/* Continues a checksum: returns that of the bytes before, which is `crc` (0: there are none), and `size`
 * bytes more. */
uint32_t iso_crc32c(uint32_t crc, const void *bytes, size_t size);

#endif
