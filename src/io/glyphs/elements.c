/* elements: radii and colours of the chemical elements.
 *
 * Van der Waals radii: from Bondi 1964 ("van der Waals Volumes and Radii", J. Phys. Chem. 68, 441) for the
 * non-metals that he lists; from Alvarez 2013 ("A cartography of the van der Waals territories", Dalton
 * Trans. 42, 8617) for all other elements, because Bondi lists few metals, with too small radii; 2 for
 * elements that neither lists. Colours: those of Jmol (jmol.sourceforge.net/jscolors), an extension of the
 * colours of Corey, Pauling and Koltun. */
#include "io/glyphs/elements.h"

#include <ctype.h>
#include <stddef.h>

static const struct {
    const char *symbol;
    float radius;
    uint32_t color; /* 0xrrggbb */
} elements[] = {
    {"", 2.00f, 0xff1493},   {"H", 1.20f, 0xffffff},  {"He", 1.40f, 0xd9ffff}, {"Li", 2.12f, 0xcc80ff},
    {"Be", 1.98f, 0xc2ff00}, {"B", 1.91f, 0xffb5b5},  {"C", 1.70f, 0x909090},  {"N", 1.55f, 0x3050f8},
    {"O", 1.52f, 0xff0d0d},  {"F", 1.47f, 0x90e050},  {"Ne", 1.54f, 0xb3e3f5}, {"Na", 2.50f, 0xab5cf2},
    {"Mg", 2.51f, 0x8aff00}, {"Al", 2.25f, 0xbfa6a6}, {"Si", 2.10f, 0xf0c8a0}, {"P", 1.80f, 0xff8000},
    {"S", 1.80f, 0xffff30},  {"Cl", 1.75f, 0x1ff01f}, {"Ar", 1.88f, 0x80d1e3}, {"K", 2.73f, 0x8f40d4},
    {"Ca", 2.62f, 0x3dff00}, {"Sc", 2.58f, 0xe6e6e6}, {"Ti", 2.46f, 0xbfc2c7}, {"V", 2.42f, 0xa6a6ab},
    {"Cr", 2.45f, 0x8a99c7}, {"Mn", 2.45f, 0x9c7ac7}, {"Fe", 2.44f, 0xe06633}, {"Co", 2.40f, 0xf090a0},
    {"Ni", 2.40f, 0x50d050}, {"Cu", 2.38f, 0xc88033}, {"Zn", 2.39f, 0x7d80b0}, {"Ga", 2.32f, 0xc28f8f},
    {"Ge", 2.29f, 0x668f8f}, {"As", 1.85f, 0xbd80e3}, {"Se", 1.90f, 0xffa100}, {"Br", 1.85f, 0xa62929},
    {"Kr", 2.02f, 0x5cb8d1}, {"Rb", 3.21f, 0x702eb0}, {"Sr", 2.84f, 0x00ff00}, {"Y", 2.75f, 0x94ffff},
    {"Zr", 2.52f, 0x94e0e0}, {"Nb", 2.56f, 0x73c2c9}, {"Mo", 2.45f, 0x54b5b5}, {"Tc", 2.44f, 0x3b9e9e},
    {"Ru", 2.46f, 0x248f8f}, {"Rh", 2.44f, 0x0a7d8c}, {"Pd", 2.15f, 0x006985}, {"Ag", 2.53f, 0xc0c0c0},
    {"Cd", 2.49f, 0xffd98f}, {"In", 2.43f, 0xa67573}, {"Sn", 2.42f, 0x668080}, {"Sb", 2.47f, 0x9e63b5},
    {"Te", 2.06f, 0xd47a00}, {"I", 1.98f, 0x940094},  {"Xe", 2.16f, 0x429eb0}, {"Cs", 3.48f, 0x57178f},
    {"Ba", 3.03f, 0x00c900}, {"La", 2.98f, 0x70d4ff}, {"Ce", 2.88f, 0xffffc7}, {"Pr", 2.92f, 0xd9ffc7},
    {"Nd", 2.95f, 0xc7ffc7}, {"Pm", 2.00f, 0xa3ffc7}, {"Sm", 2.90f, 0x8fffc7}, {"Eu", 2.87f, 0x61ffc7},
    {"Gd", 2.83f, 0x45ffc7}, {"Tb", 2.79f, 0x30ffc7}, {"Dy", 2.87f, 0x1fffc7}, {"Ho", 2.81f, 0x00ff9c},
    {"Er", 2.83f, 0x00e675}, {"Tm", 2.79f, 0x00d452}, {"Yb", 2.80f, 0x00bf38}, {"Lu", 2.74f, 0x00ab24},
    {"Hf", 2.63f, 0x4dc2ff}, {"Ta", 2.53f, 0x4da6ff}, {"W", 2.57f, 0x2194d6},  {"Re", 2.49f, 0x267dab},
    {"Os", 2.48f, 0x266696}, {"Ir", 2.41f, 0x175487}, {"Pt", 2.29f, 0xd0d0e0}, {"Au", 2.32f, 0xffd123},
    {"Hg", 2.45f, 0xb8b8d0}, {"Tl", 2.47f, 0xa6544d}, {"Pb", 2.60f, 0x575961}, {"Bi", 2.54f, 0x9e4fb5},
    {"Po", 2.00f, 0xab5c00}, {"At", 2.00f, 0x754f45}, {"Rn", 2.00f, 0x428296}, {"Fr", 2.00f, 0x420066},
    {"Ra", 2.00f, 0x007d00}, {"Ac", 2.80f, 0x70abfa}, {"Th", 2.93f, 0x00baff}, {"Pa", 2.88f, 0x00a1ff},
    {"U", 2.71f, 0x008fff},  {"Np", 2.82f, 0x0080ff}, {"Pu", 2.81f, 0x006bff}, {"Am", 2.83f, 0x545cf2},
    {"Cm", 3.05f, 0x785ce3}, {"Bk", 3.40f, 0x8a4fe3}, {"Cf", 3.05f, 0xa136d4}, {"Es", 2.70f, 0xb31fd4},
    {"Fm", 2.00f, 0xb31fba}, {"Md", 2.00f, 0xb30da6}, {"No", 2.00f, 0xbd0d87}, {"Lr", 2.00f, 0xc70066},
    {"Rf", 2.00f, 0xcc0059}, {"Db", 2.00f, 0xd1004f}, {"Sg", 2.00f, 0xd90045}, {"Bh", 2.00f, 0xe00038},
    {"Hs", 2.00f, 0xe6002e}, {"Mt", 2.00f, 0xeb0026},
};
enum { COUNT = sizeof elements / sizeof *elements };

int iso_element_of(const char *text, int length) {
    const char first = (char)(length > 0 ? toupper((unsigned char)text[0]) : 0),
               second = (char)(length > 1 ? tolower((unsigned char)text[1]) : 0);
    if (length < 1 || length > 2) return 0;
    if (length == 1 && (first == 'D' || first == 'T')) return 1; /* deuterium and tritium */
    for (int i = 1; i < COUNT; i++)
        if (elements[i].symbol[0] == first && elements[i].symbol[1] == second) return i;
    return 0;
}

int iso_element_of_number(double number) {
    return number >= 1 && number < COUNT && number == (double)(int)number ? (int)number : 0;
}

float iso_element_radius(int element) {
    return elements[element].radius;
}

void iso_element_color(int element, uint8_t color[3]) {
    for (int k = 0; k < 3; k++) color[k] = (uint8_t)(elements[element].color >> (16 - 8 * k));
}
