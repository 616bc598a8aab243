/* vectors: eigenvectors of tensors, glyphs and streamlines of vector volumes, and the axes of the volumes
 * that they come from. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/tensor.h"
#include "check_support.h"
#include "extract/points/points.h"
#include "extract/vectors/gradient_glyphs.h"
#include "extract/vectors/streamlines.h"
#include "extract/vectors/vector_glyphs.h"
#include "grids/volume/vectors_read.h"
#include "make_volumes.h"

#define FILE_NRRD ISO_TEST_TMP "/test_vectors.nrrd"
#define FILE_MHA ISO_TEST_TMP "/test_vectors.mha"
#define FILE_VTK ISO_TEST_TMP "/test_vectors.vtk"
#define FILE_NII ISO_TEST_TMP "/test_vectors.nii"

/* ---- tensors */

static void check_eigen(const float t[6], const iso_eigen *e, double tolerance) {
    const double full[3][3] = {{(double)t[0], (double)t[1], (double)t[2]},
                               {(double)t[1], (double)t[3], (double)t[4]},
                               {(double)t[2], (double)t[4], (double)t[5]}};
    assert_true(e->values[0] >= e->values[1] && e->values[1] >= e->values[2]);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            const double *a = e->vectors[i], *b = e->vectors[k];
            near(a[0] * b[0] + a[1] * b[1] + a[2] * b[2], i == k, 1e-14);
            near(full[k][0] * a[0] + full[k][1] * a[1] + full[k][2] * a[2], e->values[i] * a[k], tolerance);
        }
}

static void test_eigen(void **state) {
    (void)state;
    uint32_t random = 7;
    for (int i = 0; i < 20000; i++) {
        float t[6];
        const int zeros = i % 4, exponent = i % 60 - 30;
        double size = 0;
        for (int k = 0; k < 6; k++) {
            t[k] = (float)ldexp(uniform(&random) - 0.5, exponent);
            if (zeros && random_bits(&random) % 4 < (uint32_t)zeros) t[k] = 0;
            size = fmax(size, fabs((double)t[k]));
        }
        const iso_eigen e = iso_tensor_eigen(t);
        check_eigen(t, &e, 1e-14 * size);
    }
    const float equal[6] = {2, 0, 0, 2, 0, 2}, needle[6] = {0, 0, 0, 5, 0, 0};
    iso_eigen e = iso_tensor_eigen(equal);
    check_eigen(equal, &e, 0);
    near(iso_eigen_anisotropy(&e), 0, 0);
    e = iso_tensor_eigen(needle);
    near(iso_eigen_anisotropy(&e), 1, 1e-15);
}

/* ---- grids */

typedef void field_fn(iso_vec3 world, float *value);

/* A grid in a rotated, sheared and far-off frame, whose vectors follow a function of the world. */
static iso_vectors make_field(const int dims[3], int components, double offset, field_fn *field) {
    iso_vectors v = {.dims = {dims[0], dims[1], dims[2]}, .components = components};
    v.transform =
        (iso_transform){{offset - 8, 5 - offset, -6}, {0.8, 1, 1.25}, {0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1}};
    const iso_affine affine = iso_transform_affine(&v.transform);
    v.values = iso_alloc(iso_vectors_count(&v) * (size_t)components * sizeof *v.values);
    for (int z = 0; z < dims[2]; z++)
        for (int y = 0; y < dims[1]; y++)
            for (int x = 0; x < dims[0]; x++)
                field(iso_affine_point(&affine, iso_vec3_make(x, y, z)),
                      (float *)iso_vectors_at(&v, x, y, z));
    return v;
}

static iso_vec3 centre_of(const iso_vectors *v) {
    const iso_affine affine = iso_transform_affine(&v->transform);
    return iso_affine_point(
        &affine, iso_vec3_make((v->dims[0] - 1) / 2.0, (v->dims[1] - 1) / 2.0, (v->dims[2] - 1) / 2.0));
}

static void constant(iso_vec3 p, float *v) {
    (void)p;
    v[0] = 3, v[1] = -1, v[2] = 0.5f;
}

static iso_vec3 pivot; /* of rotation */

static void rotation(iso_vec3 p, float *v) {
    v[0] = (float)-(p.y - pivot.y), v[1] = (float)(p.x - pivot.x), v[2] = 0;
}

static void test_glyphs(void **state) {
    (void)state;
    iso_vectors v = make_field((const int[3]){7, 6, 4}, 3, 1e6, constant);
    float *first = v.values;
    first[0] = first[1] = first[2] = 0;
    first[3] = NAN;
    iso_glyphs g;
    iso_vector_glyphs_totals totals;
    iso_error error = {0};
    test_ok(iso_vector_glyphs(&v, &(iso_vector_glyphs_opts){.every = 1}, &g, &totals, &error), &error);
    assert_int_equal(totals.voxels, 168);
    assert_int_equal(g.count, 166);
    assert_int_equal(totals.zero, 1);
    assert_int_equal(totals.missing, 1);
    const float *d = g.directions[10];
    near(sqrt((double)(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])), 0.8, 1e-6); /* meets its neighbour */
    near((double)g.attributes[0].values[10], sqrt(10.25), 1e-6);
    const iso_affine affine = iso_transform_affine(&v.transform);
    const iso_vec3 last = iso_affine_point(&affine, iso_vec3_make(6, 5, 3));
    near((double)g.positions[165][0] + g.origin.x, last.x, 1e-4);
    near((double)g.positions[165][1] + g.origin.y, last.y, 1e-4);
    iso_glyphs_free(&g);
    test_ok(iso_vector_glyphs(&v, &(iso_vector_glyphs_opts){.every = 4, .scale = 2, .centred = true}, &g,
                              &totals, &error),
            &error);
    assert_int_equal(g.count, 2 * 2 * 1); /* voxels 1 and 5, 0 and 4, 1: in the middle of 7, 6, 4 */
    const iso_vec3 at = iso_affine_point(&affine, iso_vec3_make(1, 0, 1));
    near((double)g.positions[0][0] + g.origin.x + 3, at.x, 1e-4);
    near((double)g.directions[0][0], 6, 1e-6);
    iso_glyphs_free(&g);
    v.values[30] = 4; /* one that is longer */
    test_ok(iso_vector_glyphs(&v, &(iso_vector_glyphs_opts){.every = 1, .least = 4}, &g, &totals, &error),
            &error);
    assert_int_equal(g.count, 1);
    assert_int_equal(totals.small, 165);
    iso_glyphs_free(&g);
    iso_vectors_free(&v);
}

static void tensors(iso_vec3 p, float *t) {
    const double a = p.x * 0.3, c = cos(a), s = sin(a); /* eigenvalues 3, 2, 1, turned about z */
    const double values[6] = {3 * c * c + 2 * s * s, c * s, 0, 3 * s * s + 2 * c * c, 0, 1};
    for (int k = 0; k < 6; k++) t[k] = (float)values[k];
}

static void test_ellipsoids(void **state) {
    (void)state;
    iso_vectors v = make_field((const int[3]){5, 5, 5}, 6, 0, tensors);
    for (int k = 0; k < 6; k++) v.values[6 + k] = 0;
    v.values[2 * 6] = NAN;
    v.values[3 * 6 + 5] = -1; /* indefinite */
    v.values[4 * 6 + 5] = 0;  /* singular */
    iso_glyphs g, again;
    iso_vector_glyphs_totals totals;
    iso_error error = {0};
    iso_pool *pool;
    test_ok(iso_pool_create(3, &pool, &error), &error);
    test_ok(iso_vector_glyphs(&v, &(iso_vector_glyphs_opts){.every = 1}, &g, &totals, &error), &error);
    test_ok(
        iso_vector_glyphs(&v, &(iso_vector_glyphs_opts){.every = 1, .pool = pool}, &again, &totals, &error),
        &error);
    assert_int_equal(g.count, 121);
    assert_int_equal(totals.indefinite, 2);
    assert_int_equal(totals.zero, 1);
    assert_int_equal(totals.missing, 1);
    assert_memory_equal(g.axes, again.axes, g.count * sizeof *g.axes);
    assert_memory_equal(g.positions, again.positions, g.count * sizeof *g.positions);
    for (size_t i = 0; i < g.count; i++) {
        const double a = ((double)g.positions[i][0] + g.origin.x) * 0.3;
        const float *axis = g.axes[i];
        near(fabs((double)axis[0] * cos(a) + (double)axis[1] * sin(a)), 0.4, 1e-5);
        near(hypot((double)axis[3], (double)axis[4]), 0.4 * 2 / 3, 1e-5);
        near(fabs((double)axis[8]), 0.4 / 3, 1e-5);
        near((double)g.attributes[0].values[i], 2, 1e-6);
    }
    iso_glyphs_free(&g);
    iso_glyphs_free(&again);
    iso_pool_destroy(pool);
    iso_vectors_free(&v);
}

/* ---- streamlines */

static iso_lines trace(const iso_vectors *v, iso_streamlines_opts opts, iso_streamlines_totals *totals) {
    iso_lines lines;
    iso_error error = {0};
    test_ok(iso_streamlines(v, &opts, &lines, totals, &error), &error);
    return lines;
}

/* Lines of a constant field are straight, from border to border. */
static void test_straight(void **state) {
    (void)state;
    iso_vectors v = make_field((const int[3]){21, 17, 9}, 3, 0, constant);
    iso_streamlines_totals totals;
    iso_lines lines = trace(&v, (iso_streamlines_opts){.count = 40}, &totals);
    assert_int_equal(lines.line_count, 40);
    assert_int_equal(totals.left, 80);
    near(totals.step, 0.2, 1e-12);
    for (size_t line = 0; line < 40; line++) {
        const float *a = lines.vertices[lines.starts[line]];
        for (size_t i = lines.starts[line] + 1; i < lines.starts[line + 1]; i++) {
            const float *p = lines.vertices[i];
            const double along = (double)(i - lines.starts[line]) * 0.2 / sqrt(10.25);
            for (int k = 0; k < 3; k++) near((double)p[k] - (double)a[k], along * (double)v.values[k], 1e-5);
        }
    }
    iso_lines_free(&lines);
    iso_vectors_free(&v);
}

/* Lines of a rotation are circles, also far from the origin: the same as beside it to a few micrometres. */
static void test_circles(void **state) {
    (void)state;
    for (int far = 0; far < 2; far++) {
        iso_vectors v = make_field((const int[3]){41, 41, 3}, 3, 0, constant);
        pivot = centre_of(&v);
        iso_vectors_free(&v);
        pivot.x += far * 1e6;
        pivot.y -= far * 1e6;
        v = make_field((const int[3]){41, 41, 3}, 3, far * 1e6, rotation);
        iso_streamlines_totals totals;
        iso_lines lines = trace(&v, (iso_streamlines_opts){.count = 50, .length = 30}, &totals);
        double worst = 0;
        for (size_t line = 0; line < lines.line_count; line++) {
            double radius = 0;
            for (size_t i = lines.starts[line]; i < lines.starts[line + 1]; i++) {
                const double x = (double)lines.vertices[i][0] + lines.origin.x - pivot.x,
                             y = (double)lines.vertices[i][1] + lines.origin.y - pivot.y;
                if (i == lines.starts[line]) radius = hypot(x, y);
                if (radius > 1) worst = fmax(worst, fabs(hypot(x, y) - radius));
                near((double)lines.attributes[0].values[i], hypot(x, y), 2e-5);
            }
        }
        assert_true(worst < 3e-5); /* mm, floats of 4 um beside 60 mm included */
        iso_lines_free(&lines);
        iso_vectors_free(&v);
    }
}

static void test_same_for_threads(void **state) {
    (void)state;
    iso_vectors v = make_field((const int[3]){31, 21, 11}, 3, 0, constant);
    uint32_t random = 3;
    for (size_t i = 0; i < 3 * iso_vectors_count(&v); i++) v.values[i] += (float)(6 * uniform(&random) - 3);
    iso_streamlines_totals totals;
    iso_error error = {0};
    iso_pool *pool;
    test_ok(iso_pool_create(4, &pool, &error), &error);
    iso_lines one = trace(&v, (iso_streamlines_opts){.count = 200}, &totals),
              four = trace(&v, (iso_streamlines_opts){.count = 200, .pool = pool}, &totals),
              other = trace(&v, (iso_streamlines_opts){.count = 200, .seed = 1}, &totals);
    assert_int_equal(one.vertex_count, four.vertex_count);
    assert_memory_equal(one.vertices, four.vertices, one.vertex_count * sizeof *one.vertices);
    assert_memory_equal(one.starts, four.starts, 201 * sizeof *one.starts);
    assert_memory_not_equal(one.vertices, other.vertices, 12);
    iso_lines_free(&one);
    iso_lines_free(&four);
    iso_lines_free(&other);
    iso_pool_destroy(pool);
    iso_vectors_free(&v);
}

/* Vectors whose signs are random are followed as if they had none; and lines end at voxels without vectors.
 */
static void test_axial(void **state) {
    (void)state;
    iso_vectors v = make_field((const int[3]){21, 17, 9}, 3, 0, constant);
    uint32_t random = 5;
    for (size_t i = 0; i < iso_vectors_count(&v); i++)
        for (int k = 0, flip = random_bits(&random) & 1; k < 3; k++)
            if (flip) v.values[3 * i + (size_t)k] *= -1;
    iso_streamlines_totals totals;
    iso_lines lines = trace(&v, (iso_streamlines_opts){.count = 30, .axial = true}, &totals);
    assert_int_equal(totals.left, 60);
    for (size_t i = 0; i < lines.vertex_count; i++)
        near((double)lines.attributes[0].values[i], sqrt(10.25), 1e-6);
    iso_lines_free(&lines);
    for (size_t i = 0; i < 3 * iso_vectors_count(&v); i += 3) v.values[i] = NAN;
    lines = trace(&v, (iso_streamlines_opts){.count = 30}, &totals);
    assert_int_equal(lines.line_count, 0);
    assert_int_equal(totals.tried, 30000);
    iso_lines_free(&lines);
    iso_vectors_free(&v);
}

/* ---- gradients at an isosurface */

/* A linear function of the world in an oblique grid with scaled values: the gradient is the same everywhere,
 * and the solid lies where the function is large. */
static void test_gradients(void **state) {
    (void)state;
    const iso_transform transform = {{1e6, 5, -6}, {0.8, 1, 1.25}, {0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1}};
    const iso_affine affine = iso_transform_affine(&transform);
    const iso_vec3 wanted = {3, -1, 2};
    iso_error error = {0};
    iso_rgrid_desc desc = {
        .dims = {40, 30, 20}, .type = ISO_FLOAT32, .scale = 2, .offset = 7, .transform = &transform};
    iso_grid grid = {0};
    test_ok(iso_rgrid_create(&desc, &grid.rgrid, &error), &error);
    const iso_vec3 middle = iso_affine_point(&affine, iso_vec3_make(20, 15, 10));
    for (int i = 0; i < 40 * 30 * 20; i++) {
        const iso_vec3 p = iso_affine_point(&affine, iso_vec3_make(i % 40, i / 40 % 30, i / 1200));
        ((float *)grid.rgrid->data)[i] = (float)((iso_vec3_dot(wanted, iso_vec3_sub(p, middle)) - 7) / 2);
    }
    iso_point_set *points;
    test_ok(iso_point_set_create(&grid, &(iso_points_opts){.isovalue = 0.5}, &points, &error), &error);
    test_ok(iso_point_set_update(points, &error), &error);
    const iso_gradient_source sources[2] = {{&grid, iso_point_set_view(points)},
                                            {&grid, iso_point_set_view(points)}};
    iso_glyphs g;
    iso_gradient_glyphs_totals totals;
    test_ok(iso_gradient_glyphs(sources, 1, &(iso_gradient_glyphs_opts){.every = 4}, &g, &totals, &error),
            &error);
    assert_int_equal(totals.points, iso_point_view_count(&sources[0].points));
    assert_int_equal(totals.missing, 0);
    assert_true(g.count > 60 && g.count < 10 * 8 * 5);
    near(totals.scale, 4 * 0.8 / sqrt(14), 1e-5);
    for (size_t i = 0; i < g.count; i++) {
        const iso_vec3 p = {(double)g.positions[i][0] + g.origin.x, (double)g.positions[i][1] + g.origin.y,
                            (double)g.positions[i][2] + g.origin.z};
        near(iso_vec3_dot(wanted, iso_vec3_sub(p, middle)), 0.5,
             5e-3); /* on the surface: points are packed */
        near((double)g.attributes[0].values[i], sqrt(14), 1e-4);
        near((double)g.directions[i][0], -3 * totals.scale, 1e-4); /* out of the solid */
        near((double)g.directions[i][1], totals.scale, 1e-4);
        near((double)g.directions[i][2], -2 * totals.scale, 1e-4);
    }
    const size_t count = g.count;
    iso_glyphs_free(&g);
    test_ok(iso_gradient_glyphs(sources, 2, &(iso_gradient_glyphs_opts){.every = 4, .scale = 5}, &g, &totals,
                                &error),
            &error);
    assert_int_equal(g.count, 2 * count);
    assert_memory_equal(g.directions[0], g.directions[count], count * sizeof *g.directions);
    near((double)g.directions[count][1], 5, 1e-4);
    iso_glyphs_free(&g);
    assert_int_equal(
        iso_gradient_glyphs(sources, 1, &(iso_gradient_glyphs_opts){.max_memory = 1000}, &g, &totals, &error),
        ISO_ERR_LIMIT);
    iso_point_set_destroy(points);
    iso_grid_destroy(&grid);
}

/* ---- files: one vector or tensor, and the axes that it has in the world */

static iso_vectors read_file(const char *path, iso_vectors_opts opts, iso_vectors_info *info) {
    iso_vectors v = {0};
    iso_error error = {0};
    test_ok(iso_vectors_read(path, &opts, &v, info, &error), &error);
    return v;
}

static void check_file(const char *path, iso_vectors_opts opts, const double *wanted, int count) {
    iso_vectors_info info;
    iso_vectors v = read_file(path, opts, &info);
    assert_int_equal(v.components, count);
    for (int k = 0; k < count; k++) near((double)v.values[k], wanted[k], 1e-6);
    iso_vectors_free(&v);
}

static void write_nrrd(const char *lines, int components, const char *values) {
    char text[1024];
    snprintf(text, sizeof text,
             "NRRD0005\ntype: float\ndimension: 4\nsizes: %d 1 1 1\nencoding: ascii\n%s\n%s\n", components,
             lines, values);
    vol_write_text(FILE_NRRD, text);
}

static void test_nrrd_axes(void **state) {
    (void)state;
    const iso_vectors_opts plain = {0};
    write_nrrd("space: RAS\nspace directions: none (2,0,0) (0,2,0) (0,0,2)\n", 3, "1 2 3");
    check_file(FILE_NRRD, plain, (const double[]){-1, -2, 3}, 3);
    check_file(FILE_NRRD, (iso_vectors_opts){.axes = ISO_VECTOR_AXES_LPS}, (const double[]){1, 2, 3}, 3);
    /* x of the volume runs to the right, y to the front: -1, -1 in LPS; right-handed */
    check_file(FILE_NRRD, (iso_vectors_opts){.axes = ISO_VECTOR_AXES_VOXELS}, (const double[]){-1, -2, 3}, 3);
    check_file(FILE_NRRD, (iso_vectors_opts){.axes = ISO_VECTOR_AXES_FSL}, (const double[]){1, -2, 3}, 3);
    write_nrrd("space: LPS\nspace directions: none (2,0,0) (0,2,0) (0,0,2)\n"
               "measurement frame: (0,1,0) (-1,0,0) (0,0,1)\n",
               3, "1 2 3");
    check_file(FILE_NRRD, plain, (const double[]){-2, 1, 3}, 3); /* columns: x to y, y to -x */
    write_nrrd("space: RAS\nkinds: 3D-masked-symmetric-matrix space space space\n"
               "space directions: none (2,0,0) (0,2,0) (0,0,2)\nmeasurement frame: (0,1,0) (0,0,1) (1,0,0)\n",
               7, "1 11 12 13 22 23 33");
    /* x to y, y to z, z to x of RAS; then x and y change signs */
    check_file(FILE_NRRD, plain, (const double[]){33, 13, -23, 11, -12, 22}, 6);
    write_nrrd("space: LPS\nspace directions: none (2,0,0) (0,2,0) (0,0,2)\n", 9, "1 2 3 4 5 6 7 8 9");
    check_file(FILE_NRRD, plain, (const double[]){1, 3, 5, 5, 7, 9}, 6);
    iso_vectors_info info;
    iso_vectors v = read_file(FILE_NRRD, plain, &info);
    near(info.asymmetry, 4, 0);
    iso_vectors_free(&v);
    write_nrrd("space: LPS\nspace directions: none (2,0,0) (0,2,0) (0,0,2)\n", 7, "0.4 1 0 0 1 0 1");
    v = read_file(FILE_NRRD, plain, &info);
    for (int k = 0; k < 6; k++) assert_true(isnan(v.values[k])); /* outside the mask */
    iso_vectors_free(&v);
}

static void test_orders(void **state) {
    (void)state;
    static const double right[] = {11, 12, 13, 22, 23, 33};
    vol_write_text(
        FILE_VTK,
        "# vtk DataFile Version 4.2\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 1 1 1\nORIGIN 4 5 6\n"
        "POINT_DATA 1\nSCALARS s float\nLOOKUP_TABLE default\n5\n"
        "TENSORS6 t float\n11 22 33 12 23 13\nVECTORS v float\n1 2 3\n");
    check_file(FILE_VTK, (iso_vectors_opts){0}, right, 6);
    check_file(FILE_VTK, (iso_vectors_opts){.array = "v"}, (const double[]){1, 2, 3}, 3);
    check_file(FILE_VTK, (iso_vectors_opts){.array = "v", .axes = ISO_VECTOR_AXES_RAS},
               (const double[]){-1, -2, 3}, 3);
    iso_vectors_info info;
    iso_vectors v = read_file(FILE_VTK, (iso_vectors_opts){.axes = ISO_VECTOR_AXES_RAS}, &info);
    near(v.transform.origin[0], -4, 0); /* the format states no space: positions turn, too */
    near(v.transform.origin[1], -5, 0);
    near(v.transform.origin[2], 6, 0);
    iso_vectors_free(&v);
    vol_write_text(FILE_MHA, "ObjectType = Image\nNDims = 3\nDimSize = 1 1 1\nElementNumberOfChannels = 6\n"
                             "ElementType = MET_UCHAR\nElementDataFile = LOCAL\n\x0b\x0c\x0d\x16\x17\x21");
    check_file(FILE_MHA, (iso_vectors_opts){0}, right, 6);
    check_file(FILE_MHA, (iso_vectors_opts){.order = {1, 4, 5, 2, 6, 3}},
               (const double[]){11, 22, 23, 12, 33, 13}, 6); /* diagonal first, as MRtrix has it */
}

static void write_nifti(int components, int intent, const float *values) {
    vol_nifti header;
    const vol_spec spec = {{1, 1, 1}, ISO_SCALAR_FLOAT, components, false};
    vol_nifti_make(&header, 1, &spec);
    const int16_t code = (int16_t)intent;
    memcpy(header.bytes + 68, &code, sizeof code);
    unsigned char bytes[544 + 64];
    memcpy(bytes, header.bytes, header.count);
    memcpy(bytes + header.count, values, (size_t)components * sizeof *values);
    vol_write_bytes(FILE_NII, bytes, header.count + (size_t)components * sizeof *values);
}

static void test_nifti_axes(void **state) {
    (void)state;
    iso_vectors_info info;
    write_nifti(3, 1007, (const float[]){1, 2, 3});
    check_file(FILE_NII, (iso_vectors_opts){0}, (const double[]){-1, -2, 3}, 3);
    iso_vectors v = read_file(FILE_NII, (iso_vectors_opts){0}, &info);
    assert_true(info.ras && !info.axes_stated);
    iso_vectors_free(&v);
    write_nifti(6, 1005, (const float[]){11, 12, 22, 13, 23, 33}); /* the lower triangle */
    check_file(FILE_NII, (iso_vectors_opts){0}, (const double[]){11, 12, -13, 22, -23, 33}, 6);
    write_nifti(6, 0, (const float[]){11, 12, 13, 22, 23, 33}); /* FSL's: the upper one */
    check_file(FILE_NII, (iso_vectors_opts){0}, (const double[]){11, 12, -13, 22, -23, 33}, 6);
}

static void test_refusals(void **state) {
    (void)state;
    iso_vectors v;
    iso_vectors_info info;
    iso_error error = {0};
    write_nrrd("space: LPS\nspace directions: none (2,0,0) (0,2,0) (0,0,2)\n", 2, "1 2");
    assert_int_equal(iso_vectors_read(FILE_NRRD, NULL, &v, &info, &error), ISO_ERR_EMPTY);
    assert_non_null(strstr(error.text, "2 components"));
    write_nrrd("space: LPS\nspace directions: none (2,0,0) (0,2,0) (0,0,2)\n", 3, "1 2 3");
    assert_int_equal(iso_vectors_read(FILE_NRRD, &(iso_vectors_opts){.max_memory = 10}, &v, &info, &error),
                     ISO_ERR_LIMIT);
    write_nrrd("space: LPS\nmeasurement frame: (0,1,0) (0,0,1)\n", 3, "1 2 3");
    assert_int_equal(iso_vectors_read(FILE_NRRD, NULL, &v, &info, &error), ISO_ERR_FORMAT);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_eigen),      cmocka_unit_test(test_glyphs),
        cmocka_unit_test(test_ellipsoids), cmocka_unit_test(test_straight),
        cmocka_unit_test(test_circles),    cmocka_unit_test(test_same_for_threads),
        cmocka_unit_test(test_axial),      cmocka_unit_test(test_gradients),
        cmocka_unit_test(test_nrrd_axes),  cmocka_unit_test(test_orders),
        cmocka_unit_test(test_nifti_axes), cmocka_unit_test(test_refusals)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
