/* format_vti: reads VTK's XML image data with vtkXMLImageDataReader.
 *
 * VTK always reads the header. If the values of the chosen array lie in the file as they are (raw appended
 * data, not compressed, one piece), volume.c reads or maps them from there (iso_format_place); otherwise VTK
 * reads them, whole.
 *
 * VTK reports errors as text, not by a return value, and continues with incomplete data. Therefore all its
 * messages are captured during reading, and any error makes the file unreadable. VTK's output window and the
 * threshold of its log are global; they are changed while a file is read, one file at a time, and then
 * restored. VTK's arrays are used in the grid without a copy if their type allows it. World coordinates are
 * those of the file. */
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include <vtkCallbackCommand.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDataArraySelection.h>
#include <vtkDataCompressor.h>
#include <vtkDataObject.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkLZ4DataCompressor.h>
#include <vtkLZMADataCompressor.h>
#include <vtkLogger.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLDataParser.h>
#include <vtkXMLImageDataReader.h>

#include "base/bridge_guard.hpp"
#include "base/file.h"
#include "base/memory.h"
#include "grids/volume/format.h"
#include "grids/volume/module.h"
#include "grids/volume/vti_check.h"

namespace {

/* ---- messages of VTK ---- */

class quiet_window : public vtkOutputWindow {
  public:
    static quiet_window *New();
    vtkTypeMacro(quiet_window, vtkOutputWindow);
    void DisplayText(const char *) override {}
    void DisplayWarningText(const char *) override {}
    void DisplayGenericWarningText(const char *) override {}
    void DisplayDebugText(const char *) override {}
    void DisplayErrorText(const char *text) override {
        if (said.empty()) said = text;
    }
    std::string said; /* the first error */
};
vtkStandardNewMacro(quiet_window);

std::mutex vtk_lock;

class quiet_vtk {
  public:
    quiet_vtk()
        : hold(vtk_lock), before(vtkOutputWindow::GetInstance()),
          verbosity(vtkLogger::GetCurrentVerbosityCutoff()) {
        vtkOutputWindow::SetInstance(window);
        vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
    }
    ~quiet_vtk() {
        vtkLogger::SetStderrVerbosity(verbosity);
        vtkOutputWindow::SetInstance(before);
    }
    quiet_vtk(const quiet_vtk &) = delete;
    quiet_vtk &operator=(const quiet_vtk &) = delete;

    /* The reason of the first error: what follows "vtkClass (0x...): ". Empty: there was none. What
     * algorithms say of one another, with addresses, is no reason. */
    std::string error() const {
        std::string line = iso::one_line(window->said);
        size_t object = line.find("): ");
        if (object != std::string::npos) line.erase(0, object + 3);
        return line.find("(0x") == std::string::npos ? line : "VTK's reader gives no reason";
    }

  private:
    std::lock_guard<std::mutex> hold;
    vtkSmartPointer<vtkOutputWindow> before;
    vtkLogger::Verbosity verbosity;
    vtkNew<quiet_window> window;
};

/* ---- the reader ---- */

using extent = std::array<int, 6>;

/* Asks for huge pages for arrays that VTK has allocated and not filled yet. */
void advise(vtkDataSetAttributes *attributes) {
    for (int i = 0; i < attributes->GetNumberOfArrays(); i++) {
        vtkDataArray *data = attributes->GetArray(i);
        if (!data || !data->HasStandardMemoryLayout()) continue;
        const auto values = static_cast<size_t>(data->GetNumberOfValues());
        iso_advise_huge(data->GetVoidPointer(0), values * static_cast<size_t>(data->GetDataTypeSize()));
    }
}

/* VTK's reader with access to its list of pieces, for two reasons: VTK does not initialise voxels that no
 * piece covers, and reading into huge pages takes half the time. */
class image_reader : public vtkXMLImageDataReader {
  public:
    static image_reader *New();
    vtkTypeMacro(image_reader, vtkXMLImageDataReader);
    std::vector<extent> pieces() const {
        std::vector<extent> list(PieceExtents ? static_cast<size_t>(NumberOfPieces) : 0);
        for (size_t i = 0; i < list.size(); i++)
            for (size_t k = 0; k < 6; k++) list[i][k] = PieceExtents[6 * i + k];
        return list;
    }
    /* Finds how the file stores the arrays with that name in a piece; the caller sets their `bytes`. False:
     * the position of one is not stated. */
    bool layouts(size_t piece, const iso_format_array &array, std::vector<iso_vti_layout> *found);

  protected:
    image_reader() { no_points->SetName("PointData"); }
    /* Ignores field data (arrays of other lengths than the image's), which VTK would read whatever was
     * selected. */
    int ReadPrimaryElement(vtkXMLDataElement *image) override {
        const int done = Superclass::ReadPrimaryElement(image);
        FieldDataElement = nullptr; /* borrowed from the parser */
        return done;
    }
    /* VTK's messages about cell data use the name of the point data, also when there is none. */
    int ReadPiece(vtkXMLDataElement *piece) override {
        int done = Superclass::ReadPiece(piece);
        if (done && !PointDataElements[Piece]) PointDataElements[Piece] = no_points;
        return done;
    }
    void SetupOutputData() override {
        Superclass::SetupOutputData();
        vtkImageData *image = vtkImageData::SafeDownCast(GetCurrentOutput());
        if (!image) return;
        advise(image->GetPointData());
        advise(image->GetCellData());
    }

  private:
    vtkNew<vtkXMLDataElement> no_points;
};
vtkStandardNewMacro(image_reader);

bool attribute_is(vtkXMLDataElement *element, const char *name, const char *value) {
    const char *text = element ? element->GetAttribute(name) : nullptr;
    return text && std::strcmp(text, value) == 0;
}

/* Makes the same choices as vtkXMLReader::ReadArrayValues and vtkXMLDataParser. */
bool image_reader::layouts(size_t piece, const iso_format_array &array, std::vector<iso_vti_layout> *found) {
    vtkXMLDataElement *root = GetXMLParser()->GetRootElement();
    vtkXMLDataElement *values = (array.cells ? CellDataElements : PointDataElements)[piece];
    vtkXMLDataElement *appended = root->FindNestedElementWithName("AppendedData");
    const char *compressor = GetXMLParser()->GetCompressor() ? root->GetAttribute("compressor") : nullptr;
    iso_vti_layout layout = {};
    layout.compressed = compressor != nullptr;
    layout.lzma = compressor && std::strcmp(compressor, "vtkLZMADataCompressor") == 0;
    layout.big_endian = attribute_is(root, "byte_order", "BigEndian");
    layout.header_bytes = attribute_is(root, "header_type", "UInt64") ? 8 : 4;
    layout.value_bytes = static_cast<int>(iso_scalar_size(array.scalar));
    for (int i = 0; values && i < values->GetNumberOfNestedElements(); i++) {
        vtkXMLDataElement *element = values->GetNestedElement(i);
        if (!attribute_is(element, "Name", array.name)) continue;
        layout.inside = element->GetAttribute("offset") == nullptr;
        if (layout.inside) {
            layout.position = static_cast<uint64_t>(element->GetXMLByteIndex());
            layout.encoding = attribute_is(element, "format", "binary") ? ISO_VTI_BASE64 : ISO_VTI_TEXT;
        } else {
            const vtkTypeInt64 data = GetXMLParser()->GetAppendedDataPosition();
            const char *text = element->GetAttribute("offset");
            long long offset = -1;
            if (!element->GetScalarAttribute("offset", offset) || offset < 0 || data <= 0 ||
                text[std::strspn(text, "0123456789 ")])
                return false;
            layout.position = static_cast<uint64_t>(data) + static_cast<uint64_t>(offset);
            layout.encoding = attribute_is(appended, "encoding", "raw") ? ISO_VTI_RAW : ISO_VTI_BASE64;
        }
        found->push_back(layout);
    }
    return true;
}

bool scalar_of(int type, iso_scalar *scalar) {
    switch (type) {
    case VTK_UNSIGNED_CHAR:
        *scalar = ISO_SCALAR_UINT8;
        return true;
    case VTK_CHAR:
    case VTK_SIGNED_CHAR:
        *scalar = ISO_SCALAR_INT8;
        return true;
    case VTK_UNSIGNED_SHORT:
        *scalar = ISO_SCALAR_UINT16;
        return true;
    case VTK_SHORT:
        *scalar = ISO_SCALAR_INT16;
        return true;
    case VTK_UNSIGNED_INT:
        *scalar = ISO_SCALAR_UINT32;
        return true;
    case VTK_INT:
        *scalar = ISO_SCALAR_INT32;
        return true;
    case VTK_UNSIGNED_LONG:
    case VTK_UNSIGNED_LONG_LONG:
        *scalar = ISO_SCALAR_UINT64;
        return true;
    case VTK_LONG:
    case VTK_LONG_LONG:
    case VTK_ID_TYPE:
        *scalar = ISO_SCALAR_INT64;
        return true;
    case VTK_FLOAT:
        *scalar = ISO_SCALAR_FLOAT;
        return true;
    case VTK_DOUBLE:
        *scalar = ISO_SCALAR_DOUBLE;
        return true;
    default:
        return false;
    }
}

/* ---- header ---- */

/* Checks that the file contains image data: VTK does not check it. */
iso_status check_kind(const char *path, iso_error *error) {
    FILE *file;
    ISO_TRY(iso_file_open(path, &file, nullptr, error));
    std::string head(4096, 0);
    head.resize(std::fread(&head[0], 1, head.size(), file));
    std::fclose(file);
    size_t tag = head.find("<VTKFile");
    if (tag == std::string::npos) return iso_fail(error, ISO_ERR_FORMAT, "%s: not a VTK XML file", path);
    std::string element = head.substr(tag, head.find('>', tag) - tag);
    size_t type = element.find("type=");
    if (type == std::string::npos || type + 6 >= element.size())
        return iso_fail(error, ISO_ERR_FORMAT, "%s: not a VTK XML file: no type", path);
    char quote = element[type + 5];
    std::string kind = element.substr(type + 6, element.find(quote, type + 6) - type - 6);
    if (kind == "ImageData") return ISO_OK;
    return iso_format_not_image(path, iso::one_line(kind).c_str(), error);
}

/* Checks that the file ends with the closing tag: VTK does not notice that raw appended data ends early. */
iso_status check_end(const char *path, iso_error *error) {
    FILE *file;
    ISO_TRY(iso_file_open(path, &file, nullptr, error));
    std::string tail(1024, 0);
    if (fseeko(file, -1024, SEEK_END) != 0) std::rewind(file);
    tail.resize(std::fread(&tail[0], 1, tail.size(), file));
    std::fclose(file);
    if (tail.find("</VTKFile") != std::string::npos) return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "%s: truncated: it does not end with </VTKFile>", path);
}

iso_status fail_vtk(const char *path, const quiet_vtk &vtk, iso_error *error) {
    return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %.300s", path, vtk.error().c_str());
}

void list_arrays(vtkInformation *out, bool cells, std::vector<iso_format_array> &arrays) {
    vtkInformationVector *fields =
        out->Get(cells ? vtkDataObject::CELL_DATA_VECTOR() : vtkDataObject::POINT_DATA_VECTOR());
    for (int i = 0; fields && i < fields->GetNumberOfInformationObjects(); i++) {
        vtkInformation *field = fields->GetInformationObject(i);
        const char *name = field->Get(vtkDataObject::FIELD_NAME());
        iso_format_array array = {};
        if (!name || !scalar_of(field->Get(vtkDataObject::FIELD_ARRAY_TYPE()), &array.scalar)) continue;
        std::snprintf(array.name, sizeof array.name, "%s", name);
        int components = field->Get(vtkDataObject::FIELD_NUMBER_OF_COMPONENTS());
        array.components = components < 0 ? 0 : static_cast<uint64_t>(components);
        array.cells = cells;
        int active = field->Get(vtkDataObject::FIELD_ACTIVE_ATTRIBUTE());
        array.active = (active & (1 << vtkDataSetAttributes::SCALARS)) != 0;
        arrays.push_back(array);
    }
}

void take_transform(vtkInformation *out, const int *whole, iso_transform *transform) {
    double spacing[3] = {1, 1, 1}, origin[3] = {0, 0, 0};
    if (out->Has(vtkDataObject::SPACING())) out->Get(vtkDataObject::SPACING(), spacing);
    if (out->Has(vtkDataObject::ORIGIN())) out->Get(vtkDataObject::ORIGIN(), origin);
    if (out->Has(vtkDataObject::DIRECTION())) out->Get(vtkDataObject::DIRECTION(), transform->direction);
    for (int axis = 0; axis < 3; axis++) {
        transform->origin[axis] += origin[axis];
        transform->spacing[axis] = spacing[axis] < 0 ? -spacing[axis] : spacing[axis];
        for (int i = 0; i < 3; i++) {
            double &d = transform->direction[3 * i + axis];
            if (spacing[axis] < 0) d = -d;
            /* the file's origin is at index 0, which may be outside the extent */
            transform->origin[i] += whole[2 * axis] * transform->spacing[axis] * d;
        }
    }
}

/* Whether a text consists of `count` numbers; whole: of integers of 32 bits. */
bool are_numbers(const char *text, int count, bool whole) {
    for (int i = 0; i < count; i++) {
        char *end = nullptr;
        const double number = std::strtod(text, &end);
        if (end == text || !std::isfinite(number)) return false;
        if (whole && !(number == std::floor(number) && std::fabs(number) <= INT32_MAX)) return false;
        if (whole && text + std::strspn(text, "+-0123456789 \t\r\n") < end) return false;
        text = end;
    }
    return text[std::strspn(text, " \t\r\n")] == 0;
}

/* Checks the numbers in attributes of an element. VTK ignores an attribute that is not a number, and reads
 * 1e12 as the integer 1. */
iso_status check_numbers(const char *path, vtkXMLDataElement *element, iso_error *error) {
    static const struct {
        const char *element, *name;
        int count;
        bool whole;
    } attributes[] = {{"ImageData", "WholeExtent", 6, true}, {"ImageData", "Origin", 3, false},
                      {"ImageData", "Spacing", 3, false},    {"ImageData", "Direction", 9, false},
                      {"Piece", "Extent", 6, true},          {"DataArray", "NumberOfComponents", 1, true}};
    for (const auto &attribute : attributes) {
        const char *text = element->GetAttribute(attribute.name);
        if (!text || std::strcmp(element->GetName(), attribute.element) != 0) continue;
        if (!are_numbers(text, attribute.count, attribute.whole))
            return iso_fail(error, ISO_ERR_FORMAT, "%s: %s=\"%.80s\" is not %d %snumber%s", path,
                            attribute.name, iso::one_line(text).c_str(), attribute.count,
                            attribute.whole ? "whole " : "", attribute.count == 1 ? "" : "s");
    }
    for (int i = 0; i < element->GetNumberOfNestedElements(); i++)
        ISO_TRY(check_numbers(path, element->GetNestedElement(i), error));
    return ISO_OK;
}

/* Checks that names of arrays are unique: VTK finds arrays by name, and crashes if it finds the wrong one. */
iso_status check_names(const char *path, vtkXMLDataElement *element, iso_error *error) {
    const bool holds_arrays =
        std::strcmp(element->GetName(), "PointData") == 0 || std::strcmp(element->GetName(), "CellData") == 0;
    std::set<std::string> names;
    for (int i = 0; i < element->GetNumberOfNestedElements(); i++) {
        vtkXMLDataElement *nested = element->GetNestedElement(i);
        const char *name = holds_arrays ? nested->GetAttribute("Name") : nullptr;
        if (name && !names.insert(name).second)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: two arrays of %s are named \"%.80s\"", path,
                            element->GetName(), iso::one_line(name).c_str());
        ISO_TRY(check_names(path, nested, error));
    }
    return ISO_OK;
}

/* The header, and the chosen array. */
struct header {
    const quiet_vtk *vtk; /* borrowed: collects VTK's errors */
    extent whole{0, -1, 0, -1, 0, -1};
    std::vector<iso_format_array> arrays;
    int chosen = 0;
    iso_format_place place{}; /* of the array's values, if they lie in the file as they are */
    const iso_format_array &array() const { return arrays[static_cast<size_t>(chosen)]; }
};

/* The extent of the cells between the points of `points`; an axis of one point has one cell. */
extent cell_extent(const extent &points, const extent &whole) {
    extent cells = points;
    for (size_t a = 0; a < 6; a += 2)
        if (whole[a + 1] > whole[a]) cells[a + 1]--;
    return cells;
}

uint64_t size_of(const extent &box) {
    uint64_t size = 1;
    for (size_t a = 0; a < 6; a += 2)
        if (__builtin_mul_overflow(size, static_cast<uint64_t>(int64_t{box[a + 1]} - box[a] + 1), &size))
            return UINT64_MAX;
    return size;
}

/* Whether the grid can use VTK's array: one component, and no conversion. */
bool is_lent(const iso_format_array &array) {
    return array.components == 1 && iso_scalar_is_stored(array.scalar);
}

uint64_t bytes_to_read(const iso_volume_info *info, const iso_format_array &array) {
    uint64_t grid = iso_format_size(info->dims, iso_type_size(info->type)), all;
    if (is_lent(array) || grid == UINT64_MAX) return grid;
    all = iso_format_size(info->dims, iso_scalar_size(array.scalar) * array.components);
    return __builtin_add_overflow(grid, all, &all) ? UINT64_MAX : all;
}

iso_status find_layouts(const char *path, image_reader *reader, size_t piece, const iso_format_array &array,
                        std::vector<iso_vti_layout> *layouts, iso_error *error) {
    if (reader->layouts(piece, array, layouts)) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT, "%s: the place of an array's values is not stated", path);
}

/* Finds the place of the values of the chosen array if they lie in the file as they are: in raw appended
 * data, not compressed, and in a piece that is the whole image. */
iso_status find_place(const char *path, image_reader *reader, header *found, iso_error *error) {
    const std::vector<extent> pieces = reader->pieces();
    std::vector<iso_vti_layout> layouts;
    if (pieces.size() != 1 || pieces[0] != found->whole) return ISO_OK;
    ISO_TRY(find_layouts(path, reader, 0, found->array(), &layouts, error));
    if (layouts.size() != 1) return ISO_OK;
    const iso_vti_layout &layout = layouts[0];
    iso_format_place &place = found->place;
    place.known = layout.encoding == ISO_VTI_RAW && !layout.compressed;
    place.swap = layout.big_endian != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__);
    place.scalar = found->array().scalar;
    place.position = layout.position + static_cast<uint64_t>(layout.header_bytes);
    return ISO_OK;
}

iso_status read_header(const char *path, const iso_volume_opts *opts, image_reader *reader, header *found,
                       iso_volume_info *info, iso_error *error) {
    reader->SetFileName(path);
    reader->UpdateInformation();
    vtkXMLDataElement *root = reader->GetXMLParser() ? reader->GetXMLParser()->GetRootElement() : nullptr;
    if (root) ISO_TRY(check_numbers(path, root, error));
    if (root) ISO_TRY(check_names(path, root, error));
    if (!found->vtk->error().empty()) return fail_vtk(path, *found->vtk, error);
    vtkInformation *out = reader->GetOutputInformation(0);
    extent &whole = found->whole;
    if (out->Has(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()))
        out->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole.data());
    iso_format_image image = {};
    for (size_t i = 0; i < 3; i++) {
        int64_t points = int64_t{whole[2 * i + 1]} - whole[2 * i] + 1;
        image.points[i] = points < 1 ? 0 : static_cast<uint64_t>(points);
    }
    ISO_TRY(iso_format_dims(path, image.points, info, error));
    take_transform(out, whole.data(), &info->transform);
    list_arrays(out, false, found->arrays);
    list_arrays(out, true, found->arrays);
    for (iso_format_array &array : found->arrays)
        array.tuples = size_of(array.cells ? cell_extent(whole, whole) : whole);
    image.arrays = found->arrays.data();
    image.count = static_cast<int>(found->arrays.size());
    ISO_TRY(iso_format_take_array(path, opts, &image, info, &found->chosen, error));
    ISO_TRY(find_place(path, reader, found, error));
    if (found->place.known)
        iso_format_place_room(&found->place, info);
    else
        info->read_bytes = bytes_to_read(info, found->array());
    return ISO_OK;
}

/* Whether a piece lies within the whole extent: VTK crashes if it does not. */
bool inside(const extent &piece, const extent &whole) {
    bool in = true;
    for (size_t a = 0; a < 6; a += 2)
        in = in && piece[a] >= whole[a] && piece[a + 1] <= whole[a + 1] && piece[a] <= piece[a + 1];
    return in;
}

iso_status check_pieces(const char *path, const image_reader *reader, const header &found, iso_error *error) {
    std::vector<extent> pieces = reader->pieces();
    bool cells = found.array().cells;
    for (extent &piece : pieces) {
        if (!inside(piece, found.whole))
            return iso_fail(error, ISO_ERR_FORMAT, "%s: a piece lies outside the image's extent", path);
        if (cells) piece = cell_extent(piece, found.whole);
    }
    const extent box = cells ? cell_extent(found.whole, found.whole) : found.whole;
    if (iso_vti_covered(box.data(), pieces.data()->data(), pieces.size())) return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "%s: truncated: its pieces do not cover its extent", path);
}

/* Checks the data of the chosen array in all pieces; *room: the memory that VTK needs beside the array. */
iso_status check_arrays(const char *path, image_reader *reader, const header &found, uint64_t *room,
                        iso_error *error) {
    const iso_format_array &array = found.array();
    const std::vector<extent> pieces = reader->pieces();
    *room = 0;
    for (size_t i = 0; i < pieces.size(); i++) {
        const extent box = array.cells ? cell_extent(pieces[i], found.whole) : pieces[i];
        std::vector<iso_vti_layout> layouts;
        ISO_TRY(find_layouts(path, reader, i, array, &layouts, error));
        for (iso_vti_layout &layout : layouts) {
            uint64_t each = iso_scalar_size(array.scalar) * array.components, part = 0;
            if (__builtin_mul_overflow(each, size_of(box), &layout.bytes)) layout.bytes = UINT64_MAX;
            if (layout.bytes > 0) ISO_TRY(iso_vti_check_array(path, &layout, &part, error));
            *room = std::max(*room, part);
        }
    }
    return ISO_OK;
}

/* Checks the chosen array, and adds the memory that VTK needs for it to info. */
iso_status check_values(const char *path, image_reader *reader, const header &found, iso_volume_info *info,
                        iso_error *error) {
    uint64_t room = 0;
    ISO_TRY(check_pieces(path, reader, found, error));
    ISO_TRY(check_arrays(path, reader, found, &room, error));
    if (__builtin_add_overflow(info->read_bytes, room, &info->read_bytes)) info->read_bytes = UINT64_MAX;
    return ISO_OK;
}

/* The values are not checked when the volume itself already exceeds the memory limit, unless they will not be
 * read by vti_read. */
iso_status vti_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                    iso_error *error) noexcept {
    return iso::guard(path, error, [&]() -> iso_status {
        ISO_TRY(check_kind(path, error));
        ISO_TRY(iso_vti_check_markup(path, error));
        quiet_vtk vtk;
        vtkNew<image_reader> reader;
        header found = {};
        found.vtk = &vtk;
        ISO_TRY(read_header(path, opts, reader, &found, info, error));
        *opts->place = found.place;
        if (found.place.known) ISO_TRY(check_end(path, error));
        if (!found.place.known && info->read_bytes > iso_format_memory_limit(opts)) return ISO_OK;
        return check_values(path, reader, found, info, error);
    });
}

/* ---- voxels ---- */

struct progress {
    const iso_volume_opts *opts;
    bool cancelled;
};

void on_progress(vtkObject *caller, unsigned long, void *client, void *data) {
    auto *state = static_cast<progress *>(client);
    if (!state->opts->progress || !data) return;
    if (state->opts->progress(state->opts->progress_context, *static_cast<double *>(data)) == 0) return;
    state->cancelled = true;
    if (auto *algorithm = vtkAlgorithm::SafeDownCast(caller)) algorithm->SetAbortExecute(1);
}

void select_only(vtkDataArraySelection *selection, const char *name) {
    selection->DisableAllArrays();
    if (name) selection->EnableArray(name);
}

void unregister(void *owner) {
    static_cast<vtkDataArray *>(owner)->UnRegister(nullptr);
}

iso_status make_grid(const char *path, const iso_volume_info *info, vtkDataArray *data, iso_grid *grid,
                     iso_error *error) {
    iso_scalar scalar;
    if (!scalar_of(data->GetDataType(), &scalar) || iso_scalar_stored_type(scalar) != info->type ||
        data->GetNumberOfComponents() != info->components || !data->HasStandardMemoryLayout() ||
        static_cast<uint64_t>(data->GetNumberOfTuples()) != iso_format_size(info->dims, 1))
        return iso_fail(error, ISO_ERR_IO, "%s: the array is not what its header says", path);
    if (info->components == 1 && iso_scalar_is_stored(scalar)) {
        data->Register(nullptr);
        iso_format_data lent = {data->GetVoidPointer(0), unregister, data};
        return iso_format_create(path, info, &lent, grid, error);
    }
    ISO_TRY(iso_format_create(path, info, nullptr, grid, error));
    iso_scalar_source source = {data->GetVoidPointer(0), scalar, info->components, info->component, false};
    iso_scalar_convert(&source, static_cast<size_t>(data->GetNumberOfTuples()), info->type,
                       grid->rgrid->data);
    return ISO_OK;
}

iso_status read_array(const char *path, const iso_volume_opts *opts, const quiet_vtk &vtk,
                      iso_volume_info *info, iso_grid *grid, iso_error *error) {
    vtkNew<image_reader> reader;
    header found = {};
    found.vtk = &vtk;
    iso_volume_info now = *info;
    now.note_count = now.item_count = 0;
    now.transform = iso_transform_identity();
    ISO_TRY(read_header(path, opts, reader, &found, &now, error));
    ISO_TRY(check_values(path, reader, found, &now, error));
    if (std::memcmp(now.dims, info->dims, sizeof now.dims) != 0 || now.type != info->type ||
        now.components != info->components || now.read_bytes > info->read_bytes)
        return iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", path);
    const iso_format_array &array = found.array();
    select_only(reader->GetPointDataArraySelection(), array.cells ? nullptr : array.name);
    select_only(reader->GetCellDataArraySelection(), array.cells ? array.name : nullptr);
    progress state = {opts, false};
    vtkNew<vtkCallbackCommand> command;
    command->SetCallback(on_progress);
    command->SetClientData(&state);
    reader->AddObserver(vtkCommand::ProgressEvent, command);
    reader->Update();
    if (state.cancelled) return iso_fail(error, ISO_ERR_IO, "%s: cancelled", path);
    if (!vtk.error().empty()) return fail_vtk(path, vtk, error);
    vtkImageData *image = reader->GetOutput();
    vtkDataSetAttributes *attributes =
        array.cells ? static_cast<vtkDataSetAttributes *>(image->GetCellData()) : image->GetPointData();
    vtkDataArray *data = attributes->GetArray(array.name);
    if (!data) return iso_fail(error, ISO_ERR_IO, "%s: array '%.80s' cannot be read", path, array.name);
    return make_grid(path, info, data, grid, error);
}

iso_status vti_read(const char *path, const iso_volume_opts *opts, iso_volume_info *info, iso_grid *grid,
                    iso_error *error) noexcept {
    return iso::guard(path, error, [&]() -> iso_status {
        ISO_TRY(check_kind(path, error));
        ISO_TRY(iso_vti_check_markup(path, error));
        ISO_TRY(check_end(path, error));
        quiet_vtk vtk;
        return read_array(path, opts, vtk, info, grid, error);
    });
}

size_t unpack(bool lzma, const unsigned char *packed, size_t size, unsigned char *to, size_t room) noexcept {
    size_t got = 0;
    iso_error error = {};
    const iso_status status = iso::guard("", &error, [&]() -> iso_status {
        quiet_vtk vtk;
        vtkSmartPointer<vtkDataCompressor> compressor;
        if (lzma)
            compressor = vtkSmartPointer<vtkLZMADataCompressor>::New();
        else
            compressor = vtkSmartPointer<vtkLZ4DataCompressor>::New();
        got = compressor->Uncompress(packed, size, to, room);
        return ISO_OK;
    });
    return status == ISO_OK ? got : 0;
}

const iso_format format = {"vti", "VTK", nullptr, vti_info, vti_read, nullptr};

} // namespace

ISO_MODULE(&format, nullptr, nullptr, nullptr, unpack);
