/* vtk_frame: what bench render is measured against: VTK's own pictures, in a process of their own because
 * only here VTK's rendering modules are linked: with them its object factory would put other classes in the
 * place of those that the bench measures. Needs an X display.
 *
 *   vtk_frame mesh FILE           draws a mesh; says "ready TRIANGLES RENDERER", then answers a line each:
 *     "view WIDTH HEIGHT eye(3) focal point(3) up(3) angle centre(2)"  ->  "shown"
 *     "opacity A PEELS"  ->  "shown"; PEELS 0: VTK's default, which averages colours; else depth peeling
 *     "frame"                                                          ->  "frame WALL CPU", milliseconds
 *     "covered"                                                        ->  "covered PIXELS" of a frame
 *   vtk_frame spheres|gaussians|tubes FILE   the same of points or lines, drawn by vtkOpenGLSphereMapper,
 *                                            vtkPointGaussianMapper or vtkTubeFilter with 8 sides
 *   vtk_frame cones|arrows|balls FILE        the same of directed points, drawn by vtkGlyph3DMapper, 16 sides
 *   vtk_frame picture FILE.vti OUT.png ISOVALUE SIZE THREADS           from a volume to a picture, and done
 *   vtk_frame tracts FILE.tck OUT.png RADIUS SIZE        the same from tracts, as tubes of 8 sides
 *   vtk_frame cloud FILE.ply OUT.png RADIUS SIZE         the same from points: vtkPointGaussianMapper
 *
 * FILE of a mesh: int64 vertices and triangles, then float positions (3 each), float normals, int64 corners
 * (3 each). FILE of points or lines: int64 points and lines, which have equal numbers of points (0 lines:
 * points), then float positions (3 each) and float radii, or directions (3 each).
 */
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string>
#include <vector>

#include <vtkActor.h>
#include <vtkArrowSource.h>
#include <vtkAutoInit.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkConeSource.h>
#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkGlyph3DMapper.h>
#include <vtkIdTypeArray.h>
#include <vtkNew.h>
#include <vtkOpenGLSphereMapper.h>
#include <vtkPLYReader.h>
#include <vtkPNGWriter.h>
#include <vtkPointData.h>
#include <vtkPointGaussianMapper.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkSMPTools.h>
#include <vtkSphereSource.h>
#include <vtkTubeFilter.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>
#include <vtkXMLImageDataReader.h>

VTK_MODULE_INIT(vtkRenderingOpenGL2)

namespace {

double milliseconds(clockid_t clock) {
    timespec now;
    clock_gettime(clock, &now);
    return double(now.tv_sec) * 1e3 + double(now.tv_nsec) * 1e-6;
}

/* One actor, lit per pixel by the light at the eye, on black. */
struct Window {
    vtkNew<vtkPolyDataMapper> mapper;
    vtkNew<vtkActor> actor;
    vtkNew<vtkRenderer> renderer;
    vtkNew<vtkRenderWindow> window;

    Window() {
        mapper->ScalarVisibilityOff();
        actor->SetMapper(mapper);
        actor->GetProperty()->SetColor(0.85, 0.70, 0.42);
        actor->GetProperty()->SetInterpolationToPhong();
        actor->GetProperty()->SetAmbient(0.1); /* no pixel of it is black */
        renderer->AddActor(actor);
        renderer->SetBackground(0, 0, 0);
        window->SetOffScreenRendering(1);
        window->SetMultiSamples(0);
        window->SetAlphaBitPlanes(1); /* for depth peeling */
        window->AddRenderer(renderer);
    }

    void draw() {
        window->Render();
        window->WaitForCompletion();
    }

    long covered() {
        const int *size = window->GetSize();
        vtkNew<vtkUnsignedCharArray> pixels;
        window->GetPixelData(0, 0, size[0] - 1, size[1] - 1, 0, pixels);
        long count = 0;
        const unsigned char *rgb = pixels->GetPointer(0);
        for (vtkIdType i = 0; i < pixels->GetNumberOfTuples(); i++, rgb += 3)
            count += rgb[0] || rgb[1] || rgb[2];
        return count;
    }
};

/* "OpenGL renderer string:  llvmpipe (LLVM 15.0.6, 256 bits)" -> "llvmpipe (LLVM 15.0.6, 256 bits)" */
std::string renderer_name(vtkRenderWindow *window) {
    const std::string all = window->ReportCapabilities(), key = "renderer string:";
    std::size_t at = all.find(key);
    if (at == std::string::npos) return "an unknown renderer";
    at = all.find_first_not_of(' ', at + key.size());
    return all.substr(at, all.find('\n', at) - at);
}

template <class T> bool read_array(std::FILE *file, T *to, std::int64_t count) {
    return std::fread(to, sizeof *to, std::size_t(count), file) == std::size_t(count);
}

vtkSmartPointer<vtkFloatArray> read_vectors(std::FILE *file, std::int64_t count, bool &sound) {
    auto array = vtkSmartPointer<vtkFloatArray>::New();
    array->SetNumberOfComponents(3);
    array->SetNumberOfTuples(count);
    sound = sound && read_array(file, array->GetPointer(0), 3 * count);
    return array;
}

bool read_mesh(const char *path, vtkPolyData *mesh) {
    std::FILE *file = std::fopen(path, "rb");
    std::int64_t counts[2] = {0, 0};
    bool sound = file && read_array(file, counts, 2);
    if (sound) {
        vtkNew<vtkPoints> points;
        points->SetData(read_vectors(file, counts[0], sound));
        mesh->SetPoints(points);
        mesh->GetPointData()->SetNormals(read_vectors(file, counts[0], sound));
        vtkNew<vtkIdTypeArray> corners, offsets;
        corners->SetNumberOfValues(3 * counts[1]);
        sound = sound && read_array(file, corners->GetPointer(0), 3 * counts[1]);
        offsets->SetNumberOfValues(counts[1] + 1);
        for (std::int64_t i = 0; i <= counts[1]; i++) offsets->SetValue(i, 3 * i);
        vtkNew<vtkCellArray> cells;
        cells->SetData(offsets, corners);
        mesh->SetPolys(cells);
    }
    if (file) std::fclose(file);
    return sound;
}

/* The view of a bench's line; false when it is not one. */
bool set_view(Window &shown, const char *line) {
    int width, height;
    double eye[3], focus[3], up[3], angle, centre[2];
    if (std::sscanf(line, "view %d %d %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf", &width, &height,
                    &eye[0], &eye[1], &eye[2], &focus[0], &focus[1], &focus[2], &up[0], &up[1], &up[2],
                    &angle, &centre[0], &centre[1]) != 14)
        return false;
    vtkCamera *camera = shown.renderer->GetActiveCamera();
    camera->SetPosition(eye);
    camera->SetFocalPoint(focus);
    camera->SetViewUp(up);
    camera->SetViewAngle(angle);
    camera->SetWindowCenter(centre[0], centre[1]);
    shown.window->SetSize(width, height);
    shown.renderer->ResetCameraClippingRange();
    return true;
}

/* Dual depth peeling, exact up to `peels` layers, as VTK's manual sets it up; without peels, averages that do
 * not depend on the order. */
bool set_opacity(Window &shown, const char *line) {
    double opacity;
    int peels;
    if (std::sscanf(line, "opacity %lf %d", &opacity, &peels) != 2) return false;
    shown.actor->GetProperty()->SetOpacity(opacity);
    shown.renderer->SetUseDepthPeeling(peels > 0);
    shown.renderer->SetMaximumNumberOfPeels(peels);
    shown.renderer->SetOcclusionRatio(0);
    return true;
}

void answer_frame(Window &shown) {
    shown.renderer->GetActiveCamera()->Modified();
    const double cpu = milliseconds(CLOCK_PROCESS_CPUTIME_ID), wall = milliseconds(CLOCK_MONOTONIC);
    shown.draw();
    std::printf("frame %.17g %.17g\n", milliseconds(CLOCK_MONOTONIC) - wall,
                milliseconds(CLOCK_PROCESS_CPUTIME_ID) - cpu);
}

int serve(Window &shown, long long primitives) {
    shown.window->SetSize(16, 16);
    shown.draw();
    std::printf("ready %lld %s\n", primitives, renderer_name(shown.window).c_str());
    std::fflush(stdout);
    char line[1024];
    while (std::fgets(line, sizeof line, stdin)) {
        if (set_view(shown, line) || set_opacity(shown, line)) {
            std::printf("shown\n");
        } else if (std::strcmp(line, "covered\n") == 0) {
            shown.draw();
            std::printf("covered %ld\n", shown.covered());
        } else if (std::strcmp(line, "frame\n") == 0) {
            answer_frame(shown);
        } else {
            std::printf("what?\n");
        }
        std::fflush(stdout);
    }
    return 0;
}

int refuse(const char *path, const char *what) {
    std::fprintf(stderr, "vtk_frame: %s is not %s of the bench\n", path, what);
    return 1;
}

int serve_mesh(const char *path) {
    Window shown;
    vtkNew<vtkPolyData> mesh;
    if (!read_mesh(path, mesh)) return refuse(path, "a mesh");
    shown.mapper->SetInputData(mesh);
    return serve(shown, mesh->GetNumberOfPolys());
}

/* Points, each with a cell (vtkOpenGLSphereMapper draws nothing without), or lines; with an array "radius".
 */
bool read_points(const char *path, vtkPolyData *data) {
    std::FILE *file = std::fopen(path, "rb");
    std::int64_t counts[2] = {0, 0};
    bool sound = file && read_array(file, counts, 2) && counts[0] > 0;
    if (sound) {
        const vtkIdType length = counts[1] ? counts[0] / counts[1] : 1;
        vtkNew<vtkPoints> points;
        points->SetData(read_vectors(file, counts[0], sound));
        data->SetPoints(points);
        vtkNew<vtkFloatArray> radius;
        radius->SetName("radius");
        radius->SetNumberOfTuples(counts[0]);
        sound = sound && read_array(file, radius->GetPointer(0), counts[0]);
        data->GetPointData()->AddArray(radius);
        vtkNew<vtkCellArray> cells;
        for (vtkIdType i = 0; i < counts[0]; i++) {
            if (i % length == 0) cells->InsertNextCell(static_cast<int>(length));
            cells->InsertCellPoint(i);
        }
        if (counts[1])
            data->SetLines(cells);
        else
            data->SetVerts(cells);
    }
    if (file) std::fclose(file);
    return sound;
}

/* The disc of a sphere's parallel projection, shaded by its distance from the middle: cheaper than a sphere.
 */
const char *const DISC = "//VTK::Color::Impl\n"
                         "float dist = dot(offsetVCVSOutput.xy, offsetVCVSOutput.xy);\n"
                         "if (dist > 1.0) discard;\n"
                         "ambientColor *= 1.0 - dist;\n"
                         "diffuseColor *= 1.0 - dist;\n";

int serve_points(const std::string &kind, const char *path) {
    Window shown;
    vtkNew<vtkPolyData> data;
    vtkNew<vtkTubeFilter> tubes;
    vtkNew<vtkOpenGLSphereMapper> spheres;
    vtkNew<vtkPointGaussianMapper> gaussians;
    if (!read_points(path, data)) return refuse(path, "a set of points");
    vtkIdType count = data->GetNumberOfPoints();
    if (kind == "tubes") {
        count -= data->GetNumberOfLines();
        tubes->SetInputData(data);
        tubes->SetRadius(static_cast<vtkFloatArray *>(data->GetPointData()->GetArray("radius"))->GetValue(0));
        tubes->SetNumberOfSides(8);
        tubes->CappingOn();
        tubes->Update(); /* not a part of frames */
        shown.mapper->SetInputData(tubes->GetOutput());
        return serve(shown, count);
    }
    if (kind == "spheres") {
        spheres->SetInputData(data);
        spheres->SetScaleArray("radius");
        spheres->ScalarVisibilityOff();
        shown.actor->SetMapper(spheres);
    } else {
        gaussians->SetInputData(data);
        gaussians->SetScaleArray("radius");
        gaussians->SetScaleFactor(1);
        gaussians->EmissiveOff();
        gaussians->ScalarVisibilityOff();
        gaussians->SetTriangleScale(1);
        gaussians->SetSplatShaderCode(DISC);
        shown.actor->SetMapper(gaussians);
    }
    return serve(shown, count);
}

/* Glyphs of the shapes that ours have: as long as their directions. */
int serve_directed(const std::string &kind, const char *path) {
    Window shown;
    std::FILE *file = std::fopen(path, "rb");
    std::int64_t counts[2] = {0, 0};
    bool sound = file && read_array(file, counts, 2) && counts[0] > 0;
    vtkNew<vtkPoints> points;
    vtkNew<vtkPolyData> data;
    if (sound) {
        points->SetData(read_vectors(file, counts[0], sound));
        data->SetPoints(points);
        auto directions = read_vectors(file, counts[0], sound);
        directions->SetName("direction");
        data->GetPointData()->AddArray(directions);
    }
    if (file) std::fclose(file);
    if (!sound) return refuse(path, "a set of directed points");
    vtkNew<vtkConeSource> cone;
    cone->SetRadius(1.0 / 3);
    cone->SetCenter(0.5, 0, 0);
    cone->SetResolution(16);
    vtkNew<vtkArrowSource> arrow;
    arrow->SetTipResolution(16);
    arrow->SetShaftResolution(16);
    vtkNew<vtkSphereSource> ball;
    ball->SetRadius(1);
    ball->SetThetaResolution(16);
    ball->SetPhiResolution(16);
    vtkNew<vtkGlyph3DMapper> glyphs;
    glyphs->SetInputData(data);
    glyphs->SetSourceConnection(kind == "cones"   ? cone->GetOutputPort()
                                : kind == "balls" ? ball->GetOutputPort()
                                                  : arrow->GetOutputPort());
    glyphs->SetOrientationArray("direction");
    glyphs->SetScaleArray("direction");
    glyphs->SetScaleModeToScaleByMagnitude();
    glyphs->ScalarVisibilityOff();
    shown.actor->SetMapper(glyphs);
    return serve(shown, counts[0]);
}

/* As a user of VTK would write it: the camera moved back until everything is in sight. */
void write_picture(Window &shown, const char *path) {
    vtkCamera *camera = shown.renderer->GetActiveCamera();
    camera->SetPosition(1, -1, 1);
    camera->SetViewUp(0, 0, 1);
    shown.renderer->ResetCamera();
    shown.draw();
    vtkNew<vtkWindowToImageFilter> image;
    image->SetInput(shown.window);
    image->ReadFrontBufferOff();
    image->ShouldRerenderOff();
    vtkNew<vtkPNGWriter> writer;
    writer->SetFileName(path);
    writer->SetInputConnection(image->GetOutputPort());
    writer->Write();
}

/* Lines of a .tck file of the bench: triples of floats from byte 100 on, NaNs after each line. */
bool read_tracts(const char *path, vtkPolyData *data) {
    std::FILE *file = std::fopen(path, "rb");
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> cells;
    std::vector<vtkIdType> line;
    float vertex[3];
    if (!file || std::fseek(file, 100, SEEK_SET) != 0) return false;
    while (std::fread(vertex, sizeof *vertex, 3, file) == 3 && !std::isinf(vertex[0])) {
        if (!std::isnan(vertex[0])) {
            line.push_back(points->InsertNextPoint(vertex));
            continue;
        }
        cells->InsertNextCell(vtkIdType(line.size()), line.data());
        line.clear();
    }
    std::fclose(file);
    data->SetPoints(points);
    data->SetLines(cells);
    return cells->GetNumberOfCells() > 0;
}

int make_tracts(char **values) {
    const int size = std::atoi(values[3]);
    vtkNew<vtkPolyData> data;
    if (!read_tracts(values[0], data)) return refuse(values[0], "a file of tracts");
    vtkNew<vtkTubeFilter> tubes;
    tubes->SetInputData(data);
    tubes->SetRadius(std::atof(values[2]));
    tubes->SetNumberOfSides(8);
    tubes->CappingOn();
    Window shown;
    shown.mapper->SetInputConnection(tubes->GetOutputPort());
    shown.window->SetSize(size, size);
    write_picture(shown, values[1]);
    return 0;
}

int make_cloud(char **values) {
    const int size = std::atoi(values[3]);
    vtkNew<vtkPLYReader> reader;
    reader->SetFileName(values[0]);
    Window shown;
    vtkNew<vtkPointGaussianMapper> points;
    points->SetInputConnection(reader->GetOutputPort());
    points->SetScaleFactor(std::atof(values[2]));
    points->EmissiveOff();
    points->SetTriangleScale(1);
    points->SetSplatShaderCode(DISC);
    shown.actor->SetMapper(points);
    shown.window->SetSize(size, size);
    write_picture(shown, values[1]);
    return reader->GetOutput()->GetNumberOfPoints() > 0 ? 0 : refuse(values[0], "a file of points");
}

int make_picture(char **values) {
    const int size = std::atoi(values[3]), threads = std::atoi(values[4]);
    if (threads > 1) vtkSMPTools::SetBackend("TBB");
    vtkSMPTools::Initialize(threads);
    vtkNew<vtkXMLImageDataReader> reader;
    reader->SetFileName(values[0]);
    vtkNew<vtkFlyingEdges3D> surface;
    surface->SetInputConnection(reader->GetOutputPort());
    surface->SetValue(0, std::atof(values[2]));
    surface->ComputeNormalsOn();
    surface->ComputeScalarsOff();
    Window shown;
    shown.mapper->SetInputConnection(surface->GetOutputPort());
    shown.window->SetSize(size, size);
    write_picture(shown, values[1]);
    std::printf("%lld\n", static_cast<long long>(surface->GetOutput()->GetNumberOfPolys()));
    return surface->GetOutput()->GetNumberOfPolys() > 0 ? 0 : 1;
}

} // namespace

int main(int argc, char **argv) {
    if (argc == 3 && std::strcmp(argv[1], "mesh") == 0) return serve_mesh(argv[2]);
    const bool directed =
        argc == 3 && (std::strcmp(argv[1], "cones") == 0 || std::strcmp(argv[1], "arrows") == 0 ||
                      std::strcmp(argv[1], "balls") == 0);
    if (directed) return serve_directed(argv[1], argv[2]);
    if (argc == 3) return serve_points(argv[1], argv[2]);
    if (argc == 6 && std::strcmp(argv[1], "tracts") == 0) return make_tracts(argv + 2);
    if (argc == 6 && std::strcmp(argv[1], "cloud") == 0) return make_cloud(argv + 2);
    if (argc == 7 && std::strcmp(argv[1], "picture") == 0) return make_picture(argv + 2);
    std::fprintf(
        stderr,
        "usage: vtk_frame mesh|spheres|gaussians|tubes|cones|arrows FILE | picture FILE.vti OUT.png "
        "ISOVALUE SIZE THREADS | tracts FILE.tck OUT.png RADIUS SIZE | cloud FILE.ply OUT.png RADIUS SIZE\n");
    return 2;
}
