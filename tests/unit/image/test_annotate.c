/* Scale bars, orientation markers, rulers, notes and insets: round lengths, labels, where they are, what
 * is beneath them, and letters that follow the camera; the outlines of letters, and how they are painted. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "image/annotate.h"
#include "image/font.h"

static iso_camera camera_at(iso_vec3 eye, double parallel_scale) {
    return (iso_camera){.position = eye,
                        .view_up = {0, 0, 1},
                        .view_angle = 30,
                        .orthographic = parallel_scale > 0,
                        .parallel_scale = parallel_scale};
}

static void lengths_are_round(void **state) {
    (void)state;
    static const struct {
        double millimetres; /* a fifth of the picture's width */
        double length;
        const char *label;
    } cases[] = {{10, 10, "10 mm"},     {9.9, 10, "10 mm"},   {1.4, 1, "1 mm"},      {1.5, 2, "2 mm"},
                 {0.3, 0.2, "0.2 mm"},  {0.1, 0.1, "0.1 mm"}, {0.05, 0.05, "50 µm"}, {0.0009, 0.001, "1 µm"},
                 {3e-5, 2e-5, "20 nm"}, {900, 1000, "1 m"},   {70, 50, "50 mm"},     {3e6, 2e6, "2 km"},
                 {7.5, 10, "10 mm"},    {250, 200, "20 cm"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const iso_camera camera = camera_at(iso_vec3_make(0, -1, 0), cases[i].millimetres * 5 / 2);
        char label[32];
        const double length = iso_scale_bar_length(&camera, 300, 300);
        iso_length_label(length, 10, &(iso_length_style){.world = ISO_WORLD_UNIT_MILLIMETRE}, label);
        assert_true(fabs(length / cases[i].length - 1) < 1e-12);
        assert_string_equal(label, cases[i].label);
        assert_true(iso_font_width(label) > 0);
    }
    const iso_camera perspective = camera_at(iso_vec3_make(0, -1, 0), 0);
    assert_true(iso_scale_bar_length(&perspective, 300, 300) == 0);
}

/* Units follow the size, and the unit of the file: of Angstrom small ones stay. */
static void units_follow_the_file(void **state) {
    (void)state;
    static const struct {
        double length;
        iso_length_style style;
        const char *label;
    } cases[] = {{20, {ISO_UNIT_AUTO, ISO_WORLD_UNIT_ANGSTROM}, "20 Å"},
                 {500, {ISO_UNIT_AUTO, ISO_WORLD_UNIT_ANGSTROM}, "50 nm"},
                 {5, {ISO_UNIT_ANGSTROM, ISO_WORLD_UNIT_ANGSTROM}, "5 Å"},
                 {20, {ISO_UNIT_AUTO, ISO_WORLD_UNIT_MICROMETRE}, "20 µm"},
                 {500, {ISO_UNIT_AUTO, ISO_WORLD_UNIT_MICROMETRE}, "0.5 mm"},
                 {50, {ISO_UNIT_CM, ISO_WORLD_UNIT_MILLIMETRE}, "5 cm"},
                 {0.3, {ISO_UNIT_AUTO, ISO_WORLD_UNIT_METRE}, "30 cm"},
                 {7, {ISO_UNIT_AUTO, ISO_WORLD_UNIT_NONE}, "7"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char label[32];
        iso_length_label(cases[i].length, 10, &cases[i].style, label);
        assert_string_equal(label, cases[i].label);
    }
}

static void fill(iso_image *image, const uint8_t rgba[4]) {
    for (int i = 0; i < image->width * image->height; i++) memcpy(image->rgba + 4 * i, rgba, 4);
}

static iso_image annotated(const iso_annotation *annotation, int width, int height,
                           const uint8_t background[4]) {
    iso_image image;
    assert_int_equal(iso_image_create(width, height, &image, NULL), ISO_OK);
    fill(&image, background);
    assert_int_equal(iso_annotate(&image, annotation, NULL), ISO_OK);
    return image;
}

/* The bar's ticks are as far apart as its length says; on any background dark and light are both there. */
static void bars_have_their_length(void **state) {
    (void)state;
    static const uint8_t grounds[3][4] = {{255, 255, 255, 255}, {0, 0, 0, 255}, {90, 20, 30, 0}};
    const iso_camera camera = camera_at(iso_vec3_make(0, -1, 0), 50); /* 400 pixels: 0.25 mm a pixel */
    for (int g = 0; g < 3; g++) {
        const iso_annotation annotation = {.camera = &camera, .scale_bar = true, .dark = g == 1};
        iso_image image = annotated(&annotation, 400, 400, grounds[g]);
        const int ink = g == 1 ? 255 : 0;
        int left = 400, right = -1, light = 0, dark = 0;
        for (int i = 0; i < 400 * 400; i++) {
            const uint8_t *p = image.rgba + 4 * i;
            if (p[3] == 255 && memcmp(p, grounds[g], 3) != 0) light += p[0] == 255, dark += p[0] == 0;
            const int row = i / 400, column = i % 400;
            if (row != 400 - 14 || p[3] != 255 || p[0] != ink || p[1] != ink) continue; /* through the bar */
            left = column < left ? column : left;
            right = column > right ? column : right;
        }
        assert_true(right < 400 && right - left >= 80 && right - left <= 82); /* 20 mm and the line's width */
        if (g == 2) assert_true(light > 50 && dark > 50);
        iso_image_free(&image);
    }
}

/* Pixels that differ from white in a quarter of the marker. */
static int marks(const iso_image *image, int x0, int y0, int side) {
    int count = 0;
    for (int y = y0; y < y0 + side; y++)
        for (int x = x0; x < x0 + side; x++) count += image->rgba[4 * (y * image->width + x)] < 250;
    return count;
}

/* A front view has R on the left and L on the right, one from behind the other way round. */
static void markers_follow_the_camera(void **state) {
    (void)state;
    static const uint8_t white[4] = {255, 255, 255, 255};
    enum {
        SIZE = 1000,
        TEXT = 24,
        MIDDLE = 5 * TEXT,
        LETTER = 86
    }; /* LETTER: from the middle to one's centre */
    const iso_camera front = camera_at(iso_vec3_make(0, -1, 0), 1),
                     back = camera_at(iso_vec3_make(0, 1, 0), 1);
    const iso_camera *cameras[2] = {&front, &back};
    int left[2];
    for (int i = 0; i < 2; i++) {
        const iso_annotation annotation = {
            .camera = cameras[i], .orientation_marker = true, .anatomical = true};
        iso_image image = annotated(&annotation, SIZE, SIZE, white);
        left[i] = marks(&image, MIDDLE - LETTER - TEXT / 2, SIZE - MIDDLE - TEXT / 2 - 2, TEXT + 4);
        assert_true(marks(&image, 300, 300, 600) == 0);
        iso_image_free(&image);
    }
    assert_true(left[0] > 1.3 * left[1] && left[1] > 40); /* an R has more ink than an L */
}

static bool same_color(iso_rgb a, iso_rgb b) {
    return a.r == b.r && a.g == b.g && a.b == b.b;
}

/* The ends of the published tables; lightness that only grows. */
static void colormaps_are_those_published(void **state) {
    (void)state;
    assert_true(same_color(iso_colormap_at(ISO_COLORMAP_VIRIDIS, 0), (iso_rgb){0x44, 0x01, 0x54}));
    assert_true(same_color(iso_colormap_at(ISO_COLORMAP_VIRIDIS, 7), (iso_rgb){0xFD, 0xE7, 0x25}));
    assert_true(same_color(iso_colormap_at(ISO_COLORMAP_COOLWARM, -1), (iso_rgb){0x3B, 0x4C, 0xC0}));
    assert_true(same_color(iso_colormap_at(ISO_COLORMAP_COOLWARM, 1), (iso_rgb){0xB4, 0x04, 0x26}));
    assert_true(same_color(iso_colormap_at(ISO_COLORMAP_TURBO, NAN), (iso_rgb){128, 128, 128}));
    assert_true(same_color(iso_colormap_at(ISO_COLORMAP_CIVIDIS, 0), (iso_rgb){0x00, 0x22, 0x4E}));
    assert_true(same_color(iso_colormap_at(ISO_COLORMAP_BATLOW, 1), (iso_rgb){250, 204, 250}));
    iso_error error;
    iso_colormap found;
    assert_int_equal(iso_colormap_find("batlo", &found, &error), ISO_ERR_USAGE);
    assert_non_null(strstr(error.text, "did you mean batlow?"));
    static const iso_colormap rising[] = {ISO_COLORMAP_VIRIDIS, ISO_COLORMAP_INFERNO, ISO_COLORMAP_GRAY};
    for (int i = 0; i < 3; i++)
        for (int k = 0, before = -1, light; k <= 50; k++, before = light) {
            const iso_rgb c = iso_colormap_at(rising[i], k / 50.0);
            light = 299 * c.r + 587 * c.g + 114 * c.b;
            assert_true(light > before);
        }
}

/* Down the middle of the bar run the colours of its map, highest first. */
static void color_bars_show_their_map(void **state) {
    (void)state;
    enum { SIZE = 500, TEXT = 12, X = SIZE - 14 - TEXT / 2 };
    static const uint8_t white[4] = {255, 255, 255, 255};
    const iso_camera camera = camera_at(iso_vec3_make(0, -1, 0), 1);
    const iso_color_bar bar = {.map = ISO_COLORMAP_TURBO, .low = -0.5, .high = 1e6};
    const iso_annotation annotation = {.camera = &camera, .color_bars = &bar, .color_bar_count = 1};
    iso_image image = annotated(&annotation, SIZE, SIZE, white);
    for (int y = SIZE / 4 + 1; y < 3 * SIZE / 4; y++) {
        const uint8_t *p = image.rgba + 4 * (y * SIZE + X);
        const iso_rgb wanted = iso_colormap_at(ISO_COLORMAP_TURBO, 1 - (y + 0.5 - SIZE / 4.0) / (SIZE / 2.0));
        assert_true(same_color((iso_rgb){p[0], p[1], p[2]}, wanted));
    }
    assert_true(marks(&image, SIZE - 150, SIZE / 4 - 20, 100) > 100); /* numbers beside it */
    assert_int_equal(marks(&image, 0, 100, 300), 0);
    iso_image_free(&image);
}

static void small_pictures_are_cut_off(void **state) {
    (void)state;
    const iso_color_bar bars[2] = {{.map = ISO_COLORMAP_GRAY, .low = 0, .high = 1},
                                   {.map = ISO_COLORMAP_VIRIDIS, .low = -1e-9, .high = 3}};
    static const uint8_t clear[4] = {0};
    for (int width = 1; width < 60; width += 7)
        for (int height = 1; height < 60; height += 7) {
            const iso_camera camera = camera_at(iso_vec3_make(-1, -1, 1), 10);
            const iso_annotation annotation = {.camera = &camera,
                                               .scale_bar = true,
                                               .orientation_marker = true,
                                               .anatomical = height % 2,
                                               .color_bars = bars,
                                               .color_bar_count = 2};
            iso_image image = annotated(&annotation, width, height, clear);
            iso_image_free(&image);
        }
}

/* A letter's outlines are closed, within its width, and its area by the shoelace formula is that of the
 * pixels it is painted to. */
static void letters_are_painted_as_they_are(void **state) {
    (void)state;
    static const uint8_t white[4] = {255, 255, 255, 255};
    enum { SIZE = 200, PIXELS = 128 };
    for (const char *c = "0123456789.-+ekmnuLRAPHFxyzgQ@&%"; *c; c++) {
        const char text[2] = {*c, 0};
        iso_font_edge edges[ISO_FONT_EDGES];
        const int glyph = iso_font_glyph((uint32_t)*c), count = iso_font_outline(glyph, 8, edges);
        double area = 0, sum[2] = {0, 0};
        assert_true(glyph > 0 && count > 2 && count < ISO_FONT_EDGES);
        for (int i = 0; i < count; i++) {
            const iso_font_edge *e = &edges[i];
            area += 0.5 * (e->x0 * e->y1 - e->x1 * e->y0);
            sum[0] += e->x1 - e->x0, sum[1] += e->y1 - e->y0;
            assert_true(e->x0 >= -100 && e->x0 <= iso_font_advance(glyph) + 100);
            assert_true(e->y0 >= -ISO_FONT_DESCENT && e->y0 <= ISO_FONT_ASCENT);
        }
        assert_true(sum[0] == 0 && sum[1] == 0);
        iso_drawing drawing = {.marks = NULL};
        iso_image image;
        assert_int_equal(iso_image_create(SIZE, SIZE, &image, NULL), ISO_OK);
        fill(&image, white);
        iso_drawing_text(&drawing, text, 30.3, 150.7, PIXELS, (iso_rgb){0, 0, 0});
        assert_int_equal(iso_drawing_paint(&drawing, &image, NULL), ISO_OK);
        double ink = 0;
        for (int i = 0; i < SIZE * SIZE; i++) ink += (255 - image.rgba[4 * i]) / 255.0;
        const double wanted = fabs(area) * PIXELS * PIXELS / ISO_FONT_SIZE / ISO_FONT_SIZE;
        assert_true(fabs(ink - wanted) < 0.02 * wanted + 2);
        iso_drawing_free(&drawing);
        iso_image_free(&image);
    }
}

static void texts_that_cannot_be_drawn_are_refused(void **state) {
    (void)state;
    char longest[ISO_FONT_LONGEST + 2] = {0};
    iso_error error;
    memset(longest, 'a', ISO_FONT_LONGEST);
    assert_int_equal(iso_drawing_check_text(longest, &error), ISO_OK);
    longest[ISO_FONT_LONGEST] = 'a';
    static const char *const texts[] = {"", "\u05e9\u05dc\u05d5\u05dd", "\u6f22", "two\nlines", "\xff", NULL};
    for (int i = 0; texts[i]; i++) assert_int_equal(iso_drawing_check_text(texts[i], &error), ISO_ERR_USAGE);
    assert_int_equal(iso_drawing_check_text(longest, &error), ISO_ERR_USAGE);
    assert_int_equal(iso_drawing_check_text("Größe \u03b1\u00b2 \u2265 3 \u00b5m \u00c5, \u0416", &error),
                     ISO_OK);
}

/* The first and the last column of pixels that are black in the rows of a ruler that lies flat. */
static void ruler_ends(const iso_image *image, int row, int ends[2]) {
    ends[0] = image->width, ends[1] = -1;
    for (int x = 0; x < image->width; x++) {
        if (image->rgba[4 * (row * image->width + x)] > 60) continue;
        ends[0] = x < ends[0] ? x : ends[0];
        ends[1] = x;
    }
}

/* A ruler is as long as its ends are apart in the picture, in perspective and obliquely too. */
static void rulers_have_their_length(void **state) {
    (void)state;
    static const uint8_t white[4] = {255, 255, 255, 255};
    for (int i = 0; i < 3; i++) {
        iso_camera camera = camera_at(iso_vec3_make(0, -100, 0), i ? 0 : 50);
        const iso_note note = {
            .kind = ISO_NOTE_RULER, .from = {true, {-20, 0, 0}}, .to = {true, {15, i == 2 ? 40 : 0, 0}}};
        const iso_annotation annotation = {.camera = &camera, .notes = &note, .note_count = 1};
        iso_image image = annotated(&annotation, 400, 400, white);
        double from[2], to[2];
        int ends[2];
        assert_true(iso_place_project(&note.from, &camera, 400, 400, from));
        assert_true(iso_place_project(&note.to, &camera, 400, 400, to));
        if (i == 0) assert_true(fabs(to[0] - from[0] - 140) < 1e-9);
        if (i == 1) assert_true(fabs(to[0] - from[0] - 35 * 200 / 0.2679491924311227 / 100) < 1e-6);
        ruler_ends(&image, 200, ends);
        assert_true(abs(ends[0] - (int)from[0]) <= 1 && abs(ends[1] - (int)to[0]) <= 1);
        iso_image_free(&image);
    }
    const iso_place behind = {true, {0, -200, 0}};
    const iso_camera camera = camera_at(iso_vec3_make(0, -100, 0), 0);
    double at[2];
    assert_false(iso_place_project(&behind, &camera, 400, 400, at));
}

/* An inset keeps the shape of its part, and lies in its corner. */
static void insets_lie_in_their_corner(void **state) {
    (void)state;
    for (int corner = 0; corner < 4; corner++) {
        iso_inset inset = {.box = {0.5, 0.25, 0.6, 0.4}, .corner = (iso_corner)corner};
        const int *place = inset.place;
        iso_inset_place(&inset, 1000, 800);
        assert_int_equal(inset.factor, 3);
        assert_int_equal(place[2] - place[0], 3 * 100);
        assert_int_equal(place[3] - place[1], 3 * 120);
        assert_int_equal(inset.part[0], 500);
        assert_true((place[0] < 100) == (corner == ISO_CORNER_TOP_LEFT || corner == ISO_CORNER_BOTTOM_LEFT));
        assert_true((place[1] < 100) == (corner == ISO_CORNER_TOP_LEFT || corner == ISO_CORNER_TOP_RIGHT));
        assert_true(place[0] >= 0 && place[1] >= 0 && place[2] <= 1000 && place[3] <= 800);
    }
}

/* A picture of 400 x 400 that shows something in some boxes; the rest is background. */
static iso_image picture_with(const int boxes[][4], int count) {
    static const uint8_t ground[4] = {250, 250, 250, 255};
    iso_image image;
    assert_int_equal(iso_image_create(400, 400, &image, NULL), ISO_OK);
    fill(&image, ground);
    for (int i = 0; i < count; i++)
        for (int y = boxes[i][1]; y < boxes[i][3]; y++)
            for (int x = boxes[i][0]; x < boxes[i][2]; x++)
                memset(image.rgba + 4 * (y * image.width + x), 80, 3);
    return image;
}

/* Which quarter of the picture a drawing is in: 1 right, 2 below. */
static int quarter_of(const iso_drawing *drawing) {
    double box[4];
    iso_drawing_box(drawing, box);
    assert_true(box[0] >= 0 && box[1] >= 0 && box[2] <= 400 && box[3] <= 400);
    return (box[0] + box[2] > 400) + 2 * (box[1] + box[3] > 400);
}

static void annotations_cover_little(void **state) {
    (void)state;
    const iso_camera camera = camera_at(iso_vec3_make(0, -1, 0), 50);
    const iso_legend_entry entry = {"Entry", {200, 30, 30}};
    static const int things[][4] = {{0, 0, 200, 200}, {200, 200, 400, 400}, {200, 0, 400, 200}};
    /* things in the picture; where the legend and the scale bar stand */
    static const int cases[][4] = {{0, 0, 0, 3}, {0, 1, 1, 3}, {1, 1, 0, 2}, {0, 2, 1, 2}, {0, 3, 2, 2}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (int kind = 0; kind < 2; kind++) {
            iso_image under = picture_with(things + cases[i][0], cases[i][1]);
            iso_annotation_places places = {.chosen = false};
            iso_annotation a = {.camera = &camera,
                                .scale_bar = kind == 1,
                                .legend = &entry,
                                .legend_count = kind == 0,
                                .under = &under,
                                .background = {250, 250, 250},
                                .places = &places};
            iso_drawing drawing = {.marks = NULL};
            assert_int_equal(iso_annotation_draw(&drawing, &a, 400, 400, NULL), ISO_OK);
            const int usual = kind == 0 ? 0 : 3, at = quarter_of(&drawing);
            if (cases[i][1] < 3 || kind == 0) assert_int_equal(at, cases[i][2 + kind]);
            iso_drawing_free(&drawing);
            /* the pictures that follow have it in the same place, whatever they show */
            memset(under.rgba, 80, 400 * 400 * 4);
            assert_int_equal(iso_annotation_draw(&drawing, &a, 400, 400, NULL), ISO_OK);
            assert_int_equal(quarter_of(&drawing), at);
            iso_drawing_free(&drawing);
            /* where there is no choice, as in a picture that is covered everywhere, it stays */
            places.chosen = false;
            assert_int_equal(iso_annotation_draw(&drawing, &a, 400, 400, NULL), ISO_OK);
            assert_int_equal(quarter_of(&drawing), usual);
            assert_true(places.covered[kind == 0 ? ISO_ANNOTATION_LEGEND : ISO_ANNOTATION_SCALE_BAR] > 0.95);
            iso_drawing_free(&drawing);
            iso_image_free(&under);
        }
}

/* What moves makes room for what stands where it would go, texts among it. */
static void annotations_leave_each_other_room(void **state) {
    (void)state;
    const iso_camera camera = camera_at(iso_vec3_make(0, -1, 0), 50);
    const iso_legend_entry entry = {"Entry", {200, 30, 30}};
    const iso_note note = {.kind = ISO_NOTE_TEXT, .text = "a text", .to = {.at = {0.9, 0.05, 0}}};
    static const int thing[][4] = {{0, 0, 100, 100}};
    iso_image under = picture_with(thing, 1);
    for (int noted = 0; noted < 2; noted++) {
        iso_annotation_places places = {.chosen = false};
        const iso_annotation a = {.camera = &camera,
                                  .orientation_marker = true,
                                  .legend = &entry,
                                  .legend_count = 1,
                                  .notes = &note,
                                  .note_count = noted,
                                  .under = &under,
                                  .background = {250, 250, 250},
                                  .places = &places};
        iso_drawing drawing = {.marks = NULL};
        assert_int_equal(iso_annotation_draw(&drawing, &a, 400, 400, NULL), ISO_OK);
        assert_int_equal(places.place[ISO_ANNOTATION_MARKER], 0);
        assert_true(places.place[ISO_ANNOTATION_LEGEND] != 0);
        assert_true((places.place[ISO_ANNOTATION_LEGEND] == 2) == !noted); /* the top right corner */
        assert_true(places.covered[ISO_ANNOTATION_LEGEND] == 0);
        iso_drawing_free(&drawing);
    }
    iso_image_free(&under);
}

/* Of a legend that is too large as much is drawn as there is room for, and it says how much is left out. */
static void legends_say_what_is_left_out(void **state) {
    (void)state;
    enum { ENTRIES = 200 };
    iso_legend_entry entries[ENTRIES];
    const iso_camera camera = camera_at(iso_vec3_make(0, -1, 0), 50);
    for (int i = 0; i < ENTRIES; i++) entries[i] = (iso_legend_entry){"an entry", {200, 30, 30}};
    for (int i = 0; i < 4; i++) {
        iso_annotation_places places = {.chosen = true};
        const iso_annotation a = {.camera = &camera,
                                  .legend = entries,
                                  .legend_count = i < 2 ? 10 : ENTRIES,
                                  .legend_more = i % 2 * 7,
                                  .places = &places};
        iso_drawing drawing = {.marks = NULL};
        double box[4];
        int texts = 0;
        assert_int_equal(iso_annotation_draw(&drawing, &a, 400, 400, NULL), ISO_OK);
        iso_drawing_box(&drawing, box);
        assert_true(box[0] >= 0 && box[1] >= 0 && box[2] <= 400 && box[3] <= 400);
        for (int k = 0; k < drawing.count; k++) texts += drawing.marks[k].kind == ISO_MARK_TEXT;
        const char *last = drawing.marks[drawing.count - 1].text;
        char wanted[32];
        snprintf(wanted, sizeof wanted, "+%d more", a.legend_count + a.legend_more - (texts - 1));
        assert_string_equal(last, i ? wanted : "an entry");
        assert_int_equal(places.legend_more, i ? a.legend_count + a.legend_more - (texts - 1) : 0);
        if (i > 1) assert_true(texts > 40 && texts < ENTRIES);
        iso_drawing_free(&drawing);
    }
}

/* Numbers beside bars are round, three to six of them, and at the places of their colours. */
static void ticks_are_round(void **state) {
    (void)state;
    static const struct {
        double low, high;
        const char *labels[8];
    } cases[] = {{0, 137.42, {"0", "25", "50", "75", "100", "125"}},
                 {0, 137.49, {"0", "25", "50", "75", "100", "125"}},
                 {-1.3, 2.9, {"\u22121", "0", "1", "2"}},
                 {10, 0, {"0", "2", "4", "6", "8", "10"}},
                 {1000.2, 1000.8, {"1000.2", "1000.4", "1000.6", "1000.8"}},
                 {3, 3, {"3"}},
                 {0.0012, 0.0061, {"0.002", "0.003", "0.004", "0.005", "0.006"}},
                 {-4e6, 4e6, {"\u22124e+06", "\u22122e+06", "0", "2e+06", "4e+06"}},
                 {1024, 3071, {"1500", "2000", "2500", "3000"}}};
    const iso_camera camera = camera_at(iso_vec3_make(0, -1, 0), 1);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const iso_color_bar bar = {.low = cases[i].low, .high = cases[i].high};
        const iso_annotation a = {.camera = &camera, .color_bars = &bar, .color_bar_count = 1};
        iso_drawing drawing = {.marks = NULL};
        assert_int_equal(iso_annotation_draw(&drawing, &a, 400, 400, NULL), ISO_OK);
        int count = 0;
        for (int k = 0; k < drawing.count; k++) {
            const iso_mark *m = &drawing.marks[k], *tick = k ? m - 1 : m;
            if (m->kind != ISO_MARK_TEXT) continue;
            if (count < 8 && cases[i].labels[count]) assert_string_equal(m->text, cases[i].labels[count]);
            assert_true(count++ < 7);
            if (bar.low == bar.high) continue;
            const bool minus = (unsigned char)*m->text == 0xe2;
            const double number = minus ? -atof(m->text + 3) : atof(m->text),
                         part = (number - bar.low) / (bar.high - bar.low);
            assert_int_equal(tick->kind, ISO_MARK_LINES);
            assert_true(fabs(tick->points[0][1] - (300 - 200 * part)) < 1e-6);
            assert_true(fabs(m->y - 0.5 * 9.6 - tick->points[0][1]) < 0.01);
        }
        assert_true(count >= (bar.low == bar.high ? 1 : 3));
        iso_drawing_free(&drawing);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lengths_are_round),
        cmocka_unit_test(bars_have_their_length),
        cmocka_unit_test(markers_follow_the_camera),
        cmocka_unit_test(small_pictures_are_cut_off),
        cmocka_unit_test(colormaps_are_those_published),
        cmocka_unit_test(color_bars_show_their_map),
        cmocka_unit_test(units_follow_the_file),
        cmocka_unit_test(letters_are_painted_as_they_are),
        cmocka_unit_test(texts_that_cannot_be_drawn_are_refused),
        cmocka_unit_test(rulers_have_their_length),
        cmocka_unit_test(insets_lie_in_their_corner),
        cmocka_unit_test(annotations_cover_little),
        cmocka_unit_test(annotations_leave_each_other_room),
        cmocka_unit_test(ticks_are_round),
        cmocka_unit_test(legends_say_what_is_left_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
