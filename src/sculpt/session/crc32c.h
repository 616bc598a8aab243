/* crc32c: the Castagnoli checksum (RFC 3720, appendix B.4). Internal to sculpt. */
#ifndef ISO_SCULPT_SESSION_CRC32C_H
#define ISO_SCULPT_SESSION_CRC32C_H

#include <stddef.h>
#include <stdint.h>

/* Continues a checksum: returns that of the bytes before, which is `crc` (0: there are none), and `size`
 * bytes more. */
uint32_t iso_crc32c(uint32_t crc, const void *bytes, size_t size);

#endif
