// vti_files: .vti files by vtkXMLImageDataWriter and vtkXMLImageDataReader.
#include "vti_files.h"

#include <cstdlib>
#include <cstring>

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>
#include <vtkXMLImageDataReader.h>
#include <vtkXMLImageDataWriter.h>

namespace {

int type_of(const char *name) {
    static const struct {
        const char *name;
        int type;
    } types[] = {{"uint8", VTK_UNSIGNED_CHAR},   {"int8", VTK_SIGNED_CHAR}, {"int16", VTK_SHORT},
                 {"uint16", VTK_UNSIGNED_SHORT}, {"float", VTK_FLOAT},      {"double", VTK_DOUBLE}};
    for (const auto &type : types)
        if (std::strcmp(type.name, name) == 0) return type.type;
    return VTK_VOID;
}

void add_array(vtkDataSetAttributes *attributes, vtkIdType count, const vti_spec *spec, int which) {
    vtkSmartPointer<vtkDataArray> array;
    array.TakeReference(vtkDataArray::CreateDataArray(type_of(spec->type)));
    array->SetName(spec->names[which]);
    array->SetNumberOfComponents(spec->components);
    array->SetNumberOfTuples(count);
    unsigned int state = 12345U + static_cast<unsigned int>(which);
    const bool is_small = std::strstr(spec->type, "int8") != nullptr;
    for (vtkIdType i = 0; i < count; i++)
        for (int c = 0; c < spec->components; c++) {
            state = state * 1664525U + 1013904223U;
            array->SetComponent(i, c, state >> (is_small ? 25 : 17));
        }
    attributes->AddArray(array);
}

} // namespace

int vti_write(const char *path, const vti_spec *spec) {
    vtkNew<vtkImageData> image;
    int extent[6];
    std::memcpy(extent, spec->extent, sizeof extent);
    image->SetExtent(extent);
    image->SetOrigin(spec->origin);
    image->SetSpacing(spec->spacing);
    image->SetDirectionMatrix(spec->direction);
    const bool cells = spec->flags & VTI_CELL_DATA;
    vtkDataSetAttributes *attributes =
        cells ? static_cast<vtkDataSetAttributes *>(image->GetCellData()) : image->GetPointData();
    const vtkIdType count = cells ? image->GetNumberOfCells() : image->GetNumberOfPoints();
    for (int i = 0; i < 2; i++)
        if (spec->names[i]) add_array(attributes, count, spec, i);
    if (!(spec->flags & VTI_NONE_ACTIVE))
        attributes->SetActiveScalars(spec->names[spec->flags & VTI_SECOND_ACTIVE ? 1 : 0]);
    vtkNew<vtkXMLImageDataWriter> writer;
    writer->SetFileName(path);
    writer->SetInputData(image);
    if (spec->flags & VTI_RAW)
        writer->SetDataModeToAppended();
    else
        writer->SetDataModeToBinary();
    writer->SetEncodeAppendedData(0);
    if (!(spec->flags & VTI_COMPRESSED)) writer->SetCompressorTypeToNone();
    if (spec->flags & VTI_HEADER_64)
        writer->SetHeaderTypeToUInt64();
    else
        writer->SetHeaderTypeToUInt32();
    if (spec->flags & VTI_BIG_ENDIAN) writer->SetByteOrderToBigEndian();
    if (spec->flags & VTI_TWO_PIECES) writer->SetNumberOfPieces(2);
    return writer->Write() ? 0 : 1;
}

int vti_read(const char *path, const char *name, int component, vti_image *found) {
    vtkNew<vtkXMLImageDataReader> reader;
    reader->SetFileName(path);
    reader->Update();
    vtkImageData *image = reader->GetOutput();
    const bool cells = image->GetPointData()->GetNumberOfArrays() == 0;
    vtkDataSetAttributes *attributes =
        cells ? static_cast<vtkDataSetAttributes *>(image->GetCellData()) : image->GetPointData();
    vtkDataArray *array = name ? attributes->GetArray(name) : attributes->GetScalars();
    if (!array) array = attributes->GetArray(0);
    if (!array) return 1;
    int extent[6];
    image->GetExtent(extent);
    double corner[3], next[3];
    image->TransformIndexToPhysicalPoint(extent[0], extent[2], extent[4], corner);
    std::memcpy(found->origin, corner, sizeof corner);
    for (int axis = 0; axis < 3; axis++) {
        int index[3] = {extent[0], extent[2], extent[4]};
        index[axis]++;
        image->TransformIndexToPhysicalPoint(index, next);
        found->dims[axis] = extent[2 * axis + 1] - extent[2 * axis] + (cells ? 0 : 1);
        for (int i = 0; i < 3; i++) {
            found->steps[axis][i] = next[i] - corner[i];
            if (cells) found->origin[i] += found->steps[axis][i] / 2;
        }
    }
    const vtkIdType count = array->GetNumberOfTuples();
    found->values = static_cast<double *>(std::calloc(static_cast<size_t>(count), sizeof(double)));
    if (!found->values) return 1;
    for (vtkIdType i = 0; i < count; i++) found->values[i] = array->GetComponent(i, component);
    return 0;
}
