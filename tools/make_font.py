"""Makes src/image/font/sans.ttf, the letters of pictures, from LiberationSans-Regular.ttf (Debian: fonts-liberation2, SIL Open Font
License 1.1; python3-fonttools): the characters that labels, units and names of European languages need, as plain outlines without
hints. make_font.py IN.ttf OUT.ttf. The licence reserves the name Liberation, so that the result has another one."""
import sys

from fontTools import subset
from fontTools.pens.recordingPen import DecomposingRecordingPen
from fontTools.pens.ttGlyphPen import TTGlyphPen
from fontTools.ttLib import TTFont

# Latin with accents, Greek, Cyrillic; dashes, quotes, dagger, bullet, ellipsis, per mille, primes; super- and subscripts; euro,
# ohm, Angstrom; arrows; operators.
RANGES = [(0x20, 0x7E), (0xA0, 0x17F), (0x218, 0x21B), (0x384, 0x3CE), (0x400, 0x45F), (0x490, 0x491), (0x2010, 0x2015),
          (0x2018, 0x201E), (0x2020, 0x2022), (0x2026, 0x2026), (0x2030, 0x2033), (0x2070, 0x208E), (0x20AC, 0x20AC),
          (0x2122, 0x2122), (0x2126, 0x2126), (0x212B, 0x212B), (0x2190, 0x2195), (0x2202, 0x2264), (0x2265, 0x2265)]


def main():
    source, out = sys.argv[1:3]
    font = TTFont(source)
    options = subset.Options()
    options.hinting = False
    options.layout_features = []
    options.notdef_outline = True
    options.glyph_names = False
    options.drop_tables += ["GSUB", "GPOS", "GDEF", "kern", "gasp", "DSIG", "FFTM", "VDMX", "hdmx", "LTSH", "PCLT"]
    subsetter = subset.Subsetter(options)
    subsetter.populate(unicodes=[c for low, high in RANGES for c in range(low, high + 1)])
    subsetter.subset(font)
    glyphs = font.getGlyphSet()
    plain = {}
    for name in font.getGlyphOrder():
        recorded, pen = DecomposingRecordingPen(glyphs), TTGlyphPen(None)
        glyphs[name].draw(recorded)
        recorded.replay(pen)
        plain[name] = pen.glyph()
    for name, glyph in plain.items():
        font["glyf"][name] = glyph
    font["cmap"].tables = [t for t in font["cmap"].tables if (t.platformID, t.platEncID, t.format) == (3, 1, 4)]
    for record in list(font["name"].names):
        text = {1: "Isopoint Sans", 2: "Regular", 3: "Isopoint Sans 1", 4: "Isopoint Sans", 6: "IsopointSans"}.get(record.nameID)
        if record.platformID != 3 or record.langID != 0x409 or (not text and record.nameID not in (0, 13, 14)):
            font["name"].removeNames(record.nameID, record.platformID, record.platEncID, record.langID)
        elif text:
            record.string = text
    font.recalcTimestamp = False
    font.save(out)


main()
