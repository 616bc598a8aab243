/* xml: the tags of XML as formats of arrays use it, and bytes in base64. Markup is read as it comes:
 * nothing is allocated, entities stay as they are. */
#ifndef ISO_BASE_XML_H
#define ISO_BASE_XML_H

#include <stdbool.h>
#include <stdint.h>

/* Markup that has not been read yet. */
typedef struct iso_xml {
    const char *at, *end;
} iso_xml;

/* A tag; `text` .. `end` is the text between < and >. */
typedef struct iso_xml_tag {
    const char *text, *end;
} iso_xml_tag;

enum { ISO_XML_TEXT = 256 };

/* Finds the next tag that is no comment, and moves behind it; false at the end. */
bool iso_xml_next(iso_xml *xml, iso_xml_tag *tag);
bool iso_xml_is(const iso_xml_tag *tag, const char *name);
/* Copies the value of an attribute, cut to ISO_XML_TEXT - 1 characters; false: the tag has none. */
bool iso_xml_attribute(const iso_xml_tag *tag, const char *name, char value[ISO_XML_TEXT]);
bool iso_xml_attribute_is(const iso_xml_tag *tag, const char *name, const char *wanted);

/* Decodes `bytes` bytes from the characters at *at, of which (bytes + 2) / 3 * 4 must exist, and moves behind
 * them. More bytes can follow only if this number is a multiple of three. False: the text is not base64. */
bool iso_base64_take(const char **at, uint64_t bytes, unsigned char *to);

#endif
