/* elements: the chemical elements, as the readers of molecules need them. Internal to src/io/glyphs. An
 * element is its atomic number, 0 for an unknown one. */
#ifndef ISO_IO_GLYPHS_ELEMENTS_H
#define ISO_IO_GLYPHS_ELEMENTS_H

#include <stdint.h>

/* The element with a symbol of `length` characters, in any case; 0: there is none. D and T are hydrogen. */
int iso_element_of(const char *symbol, int length);
/* The element with an atomic number; 0: there is none. */
int iso_element_of_number(double number);

/* Van der Waals radius in ångström. */
float iso_element_radius(int element);
void iso_element_color(int element, uint8_t color[3]);

#endif
