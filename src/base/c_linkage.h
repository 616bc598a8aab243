/* c_linkage: what stands between ISO_C_BEGIN and ISO_C_END has C linkage in C++, too. */
#ifndef ISO_BASE_C_LINKAGE_H
#define ISO_BASE_C_LINKAGE_H

#ifdef __cplusplus
#define ISO_C_BEGIN extern "C" {
#define ISO_C_END }
#else
#define ISO_C_BEGIN
#define ISO_C_END
#endif

#endif
