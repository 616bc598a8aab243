/* pdf_write: a drawing as one sheet of PDF 1.4 (ISO 32000-1). The font is embedded as a whole, with the
 * characters of its glyphs, so that text can be found and copied; pictures are streams of PNG's filtered
 * rows (predictor 15), and of their transparency. */
#include <stdlib.h>
#include <zlib.h>

#include "base/file.h"
#include "image/drawing_write.h"
#include "image/font.h"
#include "image/png_pack.h"

/* The objects before those of pictures. */
enum { CATALOG = 1, PAGES, PAGE, CONTENTS, FONT, DESCENDANT, DESCRIPTOR, FONT_FILE, UNICODE, INFO, PICTURES };

typedef struct writer {
    FILE *f;
    const iso_drawing *drawing;
    const iso_sheet *sheet;
    iso_pool *pool;
    long *places; /* where each object begins, by its number */
    int objects;
    bool failed; /* there was no memory */
} writer;

static void begin(writer *w, int object) {
    w->places[object] = ftell(w->f);
    fprintf(w->f, "%d 0 obj\n", object);
}

static void end(writer *w) {
    fputs("endobj\n", w->f);
}

/* Writes a stream object of compressed bytes; `more`: further entries of its dictionary. */
static void put_stream(writer *w, int object, const void *bytes, size_t size, const char *more) {
    uLongf packed = compressBound((uLong)size);
    uint8_t *out = malloc(packed);
    if (!out || compress2(out, &packed, bytes, (uLong)size, 9) != Z_OK)
        w->failed = true;
    else {
        begin(w, object);
        fprintf(w->f, "<< /Length %lu /Filter /FlateDecode%s >>\nstream\n", (unsigned long)packed, more);
        fwrite(out, 1, packed, w->f);
        fputs("\nendstream\n", w->f);
        end(w);
    }
    free(out);
}

/* ---- the sheet's contents */

static void put_color(FILE *f, iso_rgb c, const char *operator) {
    fprintf(f, "%.4g %.4g %.4g %s\n", c.r / 255.0, c.g / 255.0, c.b / 255.0, operator);
}

/* Draws along the edges of a mark: lines, or the halo around it. That of a text is no text, which would be
 * found and read a second time. */
static void put_stroke(writer *w, FILE *f, const iso_mark *mark, iso_rgb color, double width) {
    iso_edge *edges;
    const int count = iso_mark_edges(mark, &edges);
    if (count < 0) {
        w->failed = true;
        return;
    }
    put_color(f, color, "RG");
    fprintf(f, "%.6g w\n", width);
    for (int i = 0; i < count; i++) {
        const iso_edge *e = &edges[i];
        if (i == 0 || e->x0 != e[-1].x1 || e->y0 != e[-1].y1) fprintf(f, "%.6g %.6g m\n", e->x0, e->y0);
        fprintf(f, "%.6g %.6g l\n", e->x1, e->y1);
    }
    fputs("S\n", f);
    free(edges);
}

/* Bold letters are filled, and drawn along their outlines. */
static void put_text(FILE *f, const iso_mark *mark) {
    const char *at = mark->text;
    put_color(f, mark->color, "rg");
    put_color(f, mark->color, "RG");
    if (mark->bold) fprintf(f, "%.6g w\n", ISO_FONT_BOLD * mark->size);
    fprintf(f, "BT /F1 %.6g Tf %d Tr 1 0 0 -1 %.6g %.6g Tm <", mark->size, mark->bold ? 2 : 0, mark->x,
            mark->y);
    for (uint32_t c = iso_font_next(&at); c; c = iso_font_next(&at))
        fprintf(f, "%04X", (unsigned)iso_font_glyph(c));
    fputs("> Tj ET\n", f);
}

static void put_polygon(FILE *f, const iso_mark *mark) {
    put_color(f, mark->color, "rg");
    for (int i = 0; i < mark->point_count; i++)
        fprintf(f, "%.6g %.6g %s\n", mark->points[i][0], mark->points[i][1], i ? "l" : "m");
    fputs("f\n", f);
}

static void put_mark(writer *w, FILE *f, const iso_mark *mark, int picture) {
    const bool lines = mark->kind == ISO_MARK_LINES;
    if (mark->halo > 0) put_stroke(w, f, mark, mark->halo_color, (lines ? mark->width : 0) + 2 * mark->halo);
    if (lines)
        put_stroke(w, f, mark, mark->color, mark->width);
    else if (mark->kind == ISO_MARK_PICTURE)
        fprintf(f, "q %.7g 0 0 %.7g %.7g %.7g cm /P%d Do Q\n", mark->right - mark->left,
                mark->top - mark->bottom, mark->left, mark->bottom, picture);
    else
        (mark->kind == ISO_MARK_TEXT ? put_text : put_polygon)(f, mark);
}

/* Pixels of the drawing become points; y grows downwards. */
static void put_contents(writer *w) {
    char *text = NULL;
    size_t size = 0;
    const double points = iso_sheet_points(w->sheet);
    FILE *f = open_memstream(&text, &size);
    if (!f) {
        w->failed = true;
        return;
    }
    fprintf(f, "%.7g 0 0 %.7g 0 %.7g cm 1 J 1 j\n", points, -points, w->sheet->height * points);
    for (int i = 0, picture = 0; i < w->drawing->count; i++) {
        put_mark(w, f, &w->drawing->marks[i], picture);
        picture += w->drawing->marks[i].kind == ISO_MARK_PICTURE;
    }
    w->failed |= !iso_memory_stream_close(f, &text);
    if (text) put_stream(w, CONTENTS, text, size, "");
    free(text);
}

/* ---- the font */

static void put_font(writer *w) {
    FILE *f = w->f;
    begin(w, FONT);
    fprintf(
        f,
        "<< /Type /Font /Subtype /Type0 /BaseFont /IsopointSans /Encoding /Identity-H /DescendantFonts [%d 0 "
        "R] /ToUnicode %d 0 R >>\n",
        DESCENDANT, UNICODE);
    end(w);
    begin(w, DESCENDANT);
    fprintf(
        f,
        "<< /Type /Font /Subtype /CIDFontType2 /BaseFont /IsopointSans /CIDSystemInfo << /Registry (Adobe) "
        "/Ordering (Identity) /Supplement 0 >> /FontDescriptor %d 0 R /CIDToGIDMap /Identity /W [0 [",
        DESCRIPTOR);
    for (int i = 0; i < ISO_FONT_GLYPHS; i++)
        fprintf(f, i % 16 ? " %.6g" : "\n%.6g", iso_font_advance(i) * 1000.0 / ISO_FONT_SIZE);
    fputs("]] >>\n", f);
    end(w);
    begin(w, DESCRIPTOR);
    fprintf(f,
            "<< /Type /FontDescriptor /FontName /IsopointSans /Flags 4 /FontBBox [-250 -250 1250 1050] "
            "/ItalicAngle 0 /Ascent %d /Descent %d /CapHeight %d /StemV 80 /FontFile2 %d 0 R >>\n",
            ISO_FONT_ASCENT * 1000 / ISO_FONT_SIZE, -ISO_FONT_DESCENT * 1000 / ISO_FONT_SIZE,
            ISO_FONT_CAPITALS * 1000 / ISO_FONT_SIZE, FONT_FILE);
    end(w);
    char length[40];
    snprintf(length, sizeof length, " /Length1 %zu", iso_font_file_bytes);
    put_stream(w, FONT_FILE, iso_font_file, iso_font_file_bytes, length);
}

/* The character of each glyph that the drawing uses, in blocks of 100 as the format of CMaps has them. */
static void put_unicode(writer *w) {
    uint32_t characters[ISO_FONT_GLYPHS] = {0};
    int used[ISO_FONT_GLYPHS], count = 0;
    char *text = NULL;
    size_t size = 0;
    for (int i = 0; i < w->drawing->count; i++) {
        const char *at = w->drawing->marks[i].text;
        for (uint32_t c = at ? iso_font_next(&at) : 0; c; c = iso_font_next(&at)) {
            const int glyph = iso_font_glyph(c);
            if (glyph && !characters[glyph]) used[count++] = glyph;
            characters[glyph] = c;
        }
    }
    FILE *f = open_memstream(&text, &size);
    if (!f) {
        w->failed = true;
        return;
    }
    fputs("/CIDInit /ProcSet findresource begin 12 dict begin begincmap\n/CIDSystemInfo << /Registry (Adobe) "
          "/Ordering (UCS) /Supplement 0 >> def /CMapName /Adobe-Identity-UCS def /CMapType 2 def\n1 "
          "begincodespacerange <0000> <FFFF> endcodespacerange\n",
          f);
    for (int i = 0; i < count; i++) {
        if (i % 100 == 0) fprintf(f, "%d beginbfchar\n", count - i < 100 ? count - i : 100);
        fprintf(f, "<%04X> <%04X>\n", (unsigned)used[i], (unsigned)characters[used[i]]);
        if (i % 100 == 99 || i == count - 1) fputs("endbfchar\n", f);
    }
    fputs("endcmap CMapName currentdict /CMap defineresource pop end end\n", f);
    w->failed |= !iso_memory_stream_close(f, &text);
    if (text) put_stream(w, UNICODE, text, size, "");
    free(text);
}

/* ---- pictures */

static void put_transparency(writer *w, int object, const iso_image *image) {
    const size_t count = (size_t)image->width * (size_t)image->height;
    uint8_t *alpha = malloc(count);
    char more[160];
    if (!alpha) {
        w->failed = true;
        return;
    }
    for (size_t i = 0; i < count; i++) alpha[i] = image->rgba[4 * i + 3];
    snprintf(
        more, sizeof more,
        " /Type /XObject /Subtype /Image /Width %d /Height %d /ColorSpace /DeviceGray /BitsPerComponent 8",
        image->width, image->height);
    put_stream(w, object, alpha, count, more);
    free(alpha);
}

/* The rows of a picture without its alpha, filtered and compressed as in a PNG; their bytes are known only
 * when they are written, so that their length is an object of its own. */
static void put_picture(writer *w, int object, const iso_image *image) {
    FILE *f = w->f;
    const bool opaque = iso_image_is_opaque(image);
    begin(w, object);
    fprintf(
        f,
        "<< /Type /XObject /Subtype /Image /Width %d /Height %d /ColorSpace /DeviceRGB /BitsPerComponent 8 "
        "/Filter /FlateDecode /DecodeParms << /Predictor 15 /Colors 3 /BitsPerComponent 8 /Columns %d >> "
        "/Length %d 0 R",
        image->width, image->height, image->width, object + 2);
    if (!opaque) fprintf(f, " /SMask %d 0 R", object + 1);
    fputs(" >>\nstream\n", f);
    const long start = ftell(f);
    iso_png_packer packer = {.image = image, .channels = 3, .small = true, .pool = w->pool};
    do {
        w->failed |= iso_png_pack(&packer) != ISO_OK;
        for (int i = 0; i < packer.part_count && !w->failed; i++)
            fwrite(packer.parts[i].bytes, 1, packer.parts[i].size, f);
    } while (packer.part_count && !w->failed);
    iso_png_packer_free(&packer);
    const long length = ftell(f) - start;
    fputs("\nendstream\n", f);
    end(w);
    begin(w, object + 2);
    fprintf(f, "%ld\n", length);
    end(w);
    if (!opaque) {
        put_transparency(w, object + 1, image);
        return;
    }
    begin(w, object + 1);
    fputs("null\n", f);
    end(w);
}

/* ---- the document */

/* A text in UTF-16, which can hold any character. */
static void put_string(FILE *f, const char *key, const char *text) {
    if (!text) return;
    fprintf(f, " /%s <FEFF", key);
    for (uint32_t c = iso_font_next(&text); c; c = iso_font_next(&text))
        if (c > 0xFFFF)
            fprintf(f, "%04X%04X", 0xD800u + (unsigned)((c - 0x10000) >> 10),
                    0xDC00u + (unsigned)(c & 0x3FF));
        else
            fprintf(f, "%04X", (unsigned)c);
    fputs(">", f);
}

static void put_sheet(writer *w) {
    FILE *f = w->f;
    const double points = iso_sheet_points(w->sheet);
    begin(w, CATALOG);
    fprintf(f, "<< /Type /Catalog /Pages %d 0 R >>\n", PAGES);
    end(w);
    begin(w, PAGES);
    fprintf(f, "<< /Type /Pages /Kids [%d 0 R] /Count 1 >>\n", PAGE);
    end(w);
    begin(w, PAGE);
    fprintf(
        f,
        "<< /Type /Page /Parent %d 0 R /MediaBox [0 0 %.7g %.7g] /Contents %d 0 R /Resources << /Font << /F1 "
        "%d 0 R >> /XObject <<",
        PAGES, w->sheet->width * points, w->sheet->height * points, CONTENTS, FONT);
    for (int i = 0, picture = 0; i < w->drawing->count; i++)
        if (w->drawing->marks[i].kind == ISO_MARK_PICTURE)
            fprintf(f, " /P%d %d 0 R", picture, PICTURES + 3 * picture), picture++;
    fputs(" >> >> >>\n", f);
    end(w);
    begin(w, INFO);
    fputs("<<", f);
    put_string(f, "Title", w->sheet->title);
    put_string(f, "Producer", w->sheet->software);
    fputs(" >>\n", f);
    end(w);
}

static void put_document(writer *w) {
    fputs("%PDF-1.4\n%\xE2\xE3\xCF\xD3\n", w->f);
    put_sheet(w);
    put_contents(w);
    put_font(w);
    put_unicode(w);
    for (int i = 0, picture = 0; i < w->drawing->count; i++)
        if (w->drawing->marks[i].kind == ISO_MARK_PICTURE)
            put_picture(w, PICTURES + 3 * picture++, &w->drawing->marks[i].picture);
    const long table = ftell(w->f);
    fprintf(w->f, "xref\n0 %d\n0000000000 65535 f \n", w->objects);
    for (int i = 1; i < w->objects; i++) fprintf(w->f, "%010ld 00000 n \n", w->places[i]);
    fprintf(w->f, "trailer\n<< /Size %d /Root %d 0 R /Info %d 0 R >>\nstartxref\n%ld\n%%%%EOF\n", w->objects,
            CATALOG, INFO, table);
}

/* The document is made in memory, as its table tells where objects begin also in what cannot be wound
 * back. */
iso_status iso_pdf_write(const char *path, const iso_drawing *drawing, const iso_sheet *sheet, iso_pool *pool,
                         iso_error *error) {
    char *bytes = NULL;
    size_t size = 0;
    iso_sink sink;
    ISO_TRY(iso_drawing_check(drawing, error));
    writer w = {.drawing = drawing, .sheet = sheet, .pool = pool, .objects = PICTURES};
    for (int i = 0; i < drawing->count; i++) w.objects += drawing->marks[i].kind == ISO_MARK_PICTURE ? 3 : 0;
    w.places = calloc((size_t)w.objects, sizeof *w.places);
    w.f = open_memstream(&bytes, &size);
    w.failed = !w.places || !w.f;
    if (!w.failed) put_document(&w);
    if (w.f) w.failed |= ferror(w.f) || !iso_memory_stream_close(w.f, &bytes);
    free(w.places);
    if (w.failed) {
        free(bytes);
        return iso_fail(error, ISO_ERR_NOMEM, "%s: out of memory", path);
    }
    iso_status status = iso_sink_open(path, &sink, error);
    if (status == ISO_OK) {
        fwrite(bytes, 1, size, sink.stream);
        status = iso_sink_commit(&sink, error);
        iso_sink_abort(&sink);
    }
    free(bytes);
    return status;
}
