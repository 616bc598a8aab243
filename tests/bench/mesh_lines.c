/* mesh_lines MESH KNOWN: makes lines of a mesh (extract/lines), and prints as JSON how far they are from
 * the lines that the mesh was made of: distances of vertices from the other lines, and differences of
 * radii there, in mm and in radii of the known lines; their 99th percentile and maximum. KNOWN "-": only
 * counts. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/numbers.h"
#include "extract/lines/mesh_lines.h"
#include "io/lines/lines_read.h"
#include "io/mesh/mesh_read.h"

typedef struct segment {
    iso_vec3 a, b;
    double radius[2], x; /* x: of its middle */
} segment;

typedef struct segments {
    segment *list;
    size_t count;
    double half; /* length of the longest, along x */
} segments;

static iso_vec3 vertex(const iso_lines *lines, size_t i) {
    const float *v = lines->vertices[i];
    return iso_vec3_add(lines->origin, iso_vec3_make((double)v[0], (double)v[1], (double)v[2]));
}

static int compare(const void *a, const void *b) {
    return iso_compare_doubles(&((const segment *)a)->x, &((const segment *)b)->x);
}

/* Parts of segments that are no longer than `most`, mm; returns how many there are, and lists them
 * unless `list` is NULL. */
static size_t cut(const iso_lines *lines, double most, segment *list) {
    size_t count = 0;
    for (size_t line = 0; line < lines->line_count; line++)
        for (size_t i = lines->starts[line]; i + 1 < lines->starts[line + 1]; i++) {
            const iso_vec3 a = vertex(lines, i), path = iso_vec3_sub(vertex(lines, i + 1), a);
            const double radius = (double)lines->radii[i], wider = (double)lines->radii[i + 1] - radius;
            const size_t parts = 1 + (size_t)(iso_vec3_length(path) / most);
            for (size_t k = 0; k < parts; k++, count++) {
                const double u = (double)k / (double)parts, v = (double)(k + 1) / (double)parts;
                if (!list) continue;
                list[count] = (segment){iso_vec3_add(a, iso_vec3_scale(path, u)),
                                        iso_vec3_add(a, iso_vec3_scale(path, v)),
                                        {radius + u * wider, radius + v * wider},
                                        a.x + 0.5 * (u + v) * path.x};
            }
        }
    return count;
}

static segments segments_of(const iso_lines *lines) {
    segments s = {.half = 0.5 * 4 * iso_lines_usual_radius(lines)};
    s.count = cut(lines, 2 * s.half, NULL);
    s.list = calloc(s.count + 1, sizeof *s.list);
    if (!s.list) abort();
    cut(lines, 2 * s.half, s.list);
    qsort(s.list, s.count, sizeof *s.list, compare);
    return s;
}

/* The distance of a place from a segment; *radius: of the segment there. */
static double distance(const segment *s, iso_vec3 p, double *radius) {
    const iso_vec3 path = iso_vec3_sub(s->b, s->a), from = iso_vec3_sub(p, s->a);
    const double square = iso_vec3_dot(path, path);
    const double u = square > 0 ? iso_min(iso_max(iso_vec3_dot(from, path) / square, 0), 1) : 0;
    *radius = (1 - u) * s->radius[0] + u * s->radius[1];
    return iso_vec3_length(iso_vec3_sub(from, iso_vec3_scale(path, u)));
}

/* The nearest segment; of those that are as near but for a hundredth of a radius, that with the most
 * similar radius: where one line begins on another, both are there. */
static double nearest(const segments *s, iso_vec3 p, double own, double *radius) {
    const double slack = 0.01 * own + 1e-6;
    size_t lo = 0, hi = s->count;
    double best = INFINITY;
    *radius = 0;
    while (lo < hi) {
        const size_t middle = (lo + hi) / 2;
        if (s->list[middle].x < p.x)
            lo = middle + 1;
        else
            hi = middle;
    }
    for (int side = 0; side < 2; side++)
        for (size_t i = side ? lo : lo - 1; i < s->count; i += side ? 1 : SIZE_MAX) {
            double there;
            if (fabs(s->list[i].x - p.x) - s->half > best + slack) break;
            const double d = distance(&s->list[i], p, &there);
            if (d > best + slack) continue;
            if (d > best - slack && fabs(there - own) >= fabs(*radius - own)) continue;
            best = d;
            *radius = there;
        }
    return best;
}

static void print_percentiles(const char *name, double *values, size_t count) {
    if (!count) return;
    qsort(values, count, sizeof *values, iso_compare_doubles);
    printf(", \"%s\": {\"median\": %.6g, \"p99\": %.6g, \"max\": %.6g}", name, values[count / 2],
           values[(size_t)(0.99 * (double)(count - 1))], values[count - 1]);
}

/* Compares the vertices of `from` with the segments of `to`. by_known: radii of `from` are the known
 * ones. */
static void compare_lines(const char *name, const iso_lines *from, const segments *to, bool by_known) {
    double *away = calloc(4 * from->vertex_count + 1, sizeof *away), *parts = away + from->vertex_count,
           *wider = parts + from->vertex_count, *wider_parts = wider + from->vertex_count;
    char text[64];
    if (!away) abort();
    for (size_t i = 0; i < from->vertex_count; i++) {
        double there;
        const double own = (double)from->radii[i];
        away[i] = nearest(to, vertex(from, i), own, &there);
        wider[i] = fabs(there - own);
        parts[i] = away[i] / iso_max(by_known ? own : there, 1e-9);
        wider_parts[i] = wider[i] / iso_max(by_known ? own : there, 1e-9);
    }
    const struct {
        const char *name;
        double *values;
    } lists[] = {{"mm", away}, {"radii", parts}, {"wider_mm", wider}, {"wider_radii", wider_parts}};
    for (size_t i = 0; i < 4; i++) {
        snprintf(text, sizeof text, "%s_%s", name, lists[i].name);
        print_percentiles(text, lists[i].values, from->vertex_count);
    }
    free(away);
}

static iso_status run(const char *path, const char *known_path, iso_error *error) {
    iso_triangles mesh = {.triangle_count = 0};
    iso_mesh_lines made = {.pieces = 0};
    iso_lines known = {.line_count = 0};
    ISO_TRY(iso_mesh_read(path, NULL, &mesh, error));
    ISO_TRY(iso_mesh_lines_make(path, &mesh, &made, error));
    const iso_lines *lines = made.tubes.line_count ? &made.tubes : &made.ribbons;
    printf("{\"triangles\": %zu, \"mesh_vertices\": %zu, \"pieces\": %zu, \"tube_pieces\": %zu, "
           "\"ribbon_pieces\": %zu, "
           "\"tubes\": %zu, \"tube_vertices\": %zu, \"ribbons\": %zu, \"ribbon_vertices\": %zu",
           mesh.triangle_count, made.vertices, made.pieces, made.tube_pieces, made.ribbon_pieces,
           made.tubes.line_count, made.tubes.vertex_count, made.ribbons.line_count,
           made.ribbons.vertex_count);
    if (strcmp(known_path, "-") != 0) {
        ISO_TRY(iso_lines_read(known_path, NULL, &known, error));
        segments to = segments_of(&known), back = segments_of(lines);
        compare_lines("made", lines, &to, false);
        compare_lines("known", &known, &back, true);
        free(to.list);
        free(back.list);
    }
    printf("}\n");
    iso_lines_free(&known);
    iso_mesh_lines_free(&made);
    iso_triangles_free(&mesh);
    return ISO_OK;
}

int main(int argc, char **argv) {
    iso_error error = {0};
    if (argc != 3) {
        fprintf(stderr, "usage: mesh_lines MESH KNOWN|-\n");
        return 2;
    }
    const iso_status status = run(argv[1], argv[2], &error);
    if (status != ISO_OK) fprintf(stderr, "mesh_lines: %s\n", error.text);
    return iso_status_exit(status);
}
