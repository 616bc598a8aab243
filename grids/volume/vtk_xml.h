/* vtk_xml: the arrays of numbers in VTK's XML files ("VTK XML Formats", docs.vtk.org), which are text or
 * bytes. Bytes are raw or in base64, inside the element or appended after all elements, and may be divided
 * into blocks that are compressed by zlib, LZ4 or LZMA (the last two by VTK, in a module). They begin with
 * numbers that state their length; in compressed arrays these numbers are encoded in base64 separately. Every
 * length is checked before memory is taken. */
#ifndef ISO_GRIDS_VOLUME_VTK_XML_H
#define ISO_GRIDS_VOLUME_VTK_XML_H

#include "base/memory.h"
#include "base/xml.h"
#include "grids/volume/module.h"
#include "grids/volume/vti_check.h"

enum { ISO_VTK_NAME = 64 };

typedef enum iso_vtk_packing { ISO_VTK_PLAIN, ISO_VTK_ZLIB, ISO_VTK_LZ4, ISO_VTK_LZMA } iso_vtk_packing;

/* Where and how the values of an array are stored. */
typedef struct iso_vtk_array {
    char name[ISO_VTK_NAME];
    iso_scalar scalar;
    uint64_t components;
    iso_vti_encoding encoding;
    const char *begin; /* where the values begin */
} iso_vtk_array;

/* A file in memory. Set `path`, `reserve` and its context; the rest is set by iso_vtk_xml_open, and by
 * iso_vtk_xml_decode. The buffers are the caller's to free. */
typedef struct iso_vtk_xml {
    const char *path;
    /* Makes room in a buffer for `count` items of `each` bytes: iso_buffer_reserve within a limit. */
    iso_status (*reserve)(void *context, iso_buffer *buffer, size_t count, size_t each, iso_error *error);
    void *context;
    iso_xml markup;       /* the rest of it */
    const char *appended; /* where offsets into the appended data count from; NULL: there is no such data */
    const char *end;      /* the end of the file */
    bool appended_raw, big_endian;
    iso_vtk_packing packing;
    const iso_module *unpacker;       /* of LZ4 and LZMA */
    size_t header;                    /* bytes of each number in the header of an array: 4 or 8 */
    iso_buffer values, sizes, packed; /* the decoded bytes of an array; the numbers of its header */
    uint64_t bytes;                   /* number of bytes in `values` */
} iso_vtk_xml;

/* ISO_ERR_FORMAT "path: not a readable file of VTK: what", and ISO_ERR_IO "path: truncated". */
iso_status iso_vtk_xml_bad(const iso_vtk_xml *x, const char *what, iso_error *error);
iso_status iso_vtk_xml_ends(const iso_vtk_xml *x, iso_error *error);

/* Begins reading `count` bytes: finds the element VTKFile, whose type must be `type`, and the appended data.
 * ISO_ERR_FORMAT; ISO_ERR_UNSUPPORTED: arrays are compressed by another method, or by one of VTK, whose
 * module is not installed. */
iso_status iso_vtk_xml_open(iso_vtk_xml *x, const char *text, size_t count, const char *type,
                            iso_error *error);

/* Reads a count from an attribute; `missing` if there is none. */
iso_status iso_vtk_xml_count(const iso_vtk_xml *x, const iso_xml_tag *tag, const char *name, uint64_t missing,
                             uint64_t *count, iso_error *error);

/* Parses an extent: six whole numbers, of which none of the three ranges is empty. */
bool iso_vtk_xml_extent(const char *text, int extent[6]);

/* Takes what a tag DataArray says. *known is false for bits and texts. ISO_ERR_FORMAT, ISO_ERR_IO. */
iso_status iso_vtk_xml_array(const iso_vtk_xml *x, const iso_xml_tag *tag, iso_vtk_array *array, bool *known,
                             iso_error *error);
/* Finds a type such as "Float32". False: it is no type of numbers. */
bool iso_vtk_xml_type(const char *name, iso_scalar *scalar);

/* Decodes an array, which must have `count` numbers, into x->values: numbers of its type or, of text,
 * doubles. ISO_ERR_IO: truncated or corrupt; ISO_ERR_FORMAT, ISO_ERR_LIMIT, ISO_ERR_NOMEM. */
iso_status iso_vtk_xml_decode(iso_vtk_xml *x, const iso_vtk_array *array, uint64_t count, iso_error *error);
/* A number of the decoded array. */
double iso_vtk_xml_number(const iso_vtk_xml *x, const iso_vtk_array *array, uint64_t i);

#endif
