/* xml: tags, attributes, base64. */
#include "base/xml.h"

#include <ctype.h>
#include <string.h>

bool iso_xml_next(iso_xml *xml, iso_xml_tag *tag) {
    for (;;) {
        const char *open = memchr(xml->at, '<', (size_t)(xml->end - xml->at));
        if (!open) return false;
        const bool comment = xml->end - open > 4 && memcmp(open, "<!--", 4) == 0;
        const char *close = comment ? memmem(open, (size_t)(xml->end - open), "-->", 3)
                                    : memchr(open, '>', (size_t)(xml->end - open));
        if (!close) return false;
        xml->at = close + (comment ? 3 : 1);
        *tag = (iso_xml_tag){open + 1, close};
        if (!comment) return true;
    }
}

bool iso_xml_is(const iso_xml_tag *tag, const char *name) {
    const size_t length = strlen(name);
    if ((size_t)(tag->end - tag->text) < length || memcmp(tag->text, name, length) != 0) return false;
    const char *next = tag->text + length;
    return next == tag->end || isspace((unsigned char)*next) || *next == '/';
}

bool iso_xml_attribute(const iso_xml_tag *tag, const char *name, char value[ISO_XML_TEXT]) {
    const size_t length = strlen(name);
    for (const char *at = tag->text; at < tag->end; at++) {
        at = memmem(at, (size_t)(tag->end - at), name, length);
        if (!at) return false;
        const char *rest = at + length;
        if (at == tag->text || !isspace((unsigned char)at[-1])) continue;
        while (rest < tag->end && isspace((unsigned char)*rest)) rest++;
        if (rest == tag->end || *rest != '=') continue;
        do rest++;
        while (rest < tag->end && isspace((unsigned char)*rest));
        if (rest == tag->end || (*rest != '"' && *rest != '\'')) continue;
        const char *close = memchr(rest + 1, *rest, (size_t)(tag->end - rest - 1));
        if (!close) return false;
        const size_t length_of_value = (size_t)(close - rest - 1),
                     count = length_of_value < ISO_XML_TEXT ? length_of_value : ISO_XML_TEXT - 1;
        memcpy(value, rest + 1, count);
        value[count] = 0;
        return true;
    }
    return false;
}

bool iso_xml_attribute_is(const iso_xml_tag *tag, const char *name, const char *wanted) {
    char value[ISO_XML_TEXT];
    return iso_xml_attribute(tag, name, value) && strcmp(value, wanted) == 0;
}

static int digit_value(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : c == '=' ? 0 : -1;
}

bool iso_base64_take(const char **at, uint64_t bytes, unsigned char *to) {
    for (uint64_t done = 0; done < bytes; done += 3, *at += 4) {
        uint32_t bits = 0;
        for (int i = 0; i < 4; i++) {
            const int value = digit_value((*at)[i]);
            if (value < 0) return false;
            bits = bits << 6 | (uint32_t)value;
        }
        for (uint64_t i = 0; i < 3 && done + i < bytes; i++)
            to[done + i] = (unsigned char)(bits >> (16 - 8 * i));
    }
    return true;
}
