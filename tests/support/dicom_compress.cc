/* dicom_compress: compresses the pixels of a DICOM file with GDCM (dicom_files.h). */
#include "dicom_files.h"

#include <string>

#include <gdcmImageChangeTransferSyntax.h>
#include <gdcmImageReader.h>
#include <gdcmTrace.h>
#include <gdcmWriter.h>

static gdcm::TransferSyntax::TSType syntax_of(const std::string &how) {
    if (how == "rle") return gdcm::TransferSyntax::RLELossless;
    if (how == "jpeg") return gdcm::TransferSyntax::JPEGLosslessProcess14_1;
    if (how == "jpegls") return gdcm::TransferSyntax::JPEGLSLossless;
    return gdcm::TransferSyntax::JPEG2000Lossless;
}

/* The header's element with the transfer syntax, padded to an even length. */
static gdcm::DataElement transfer_syntax(const gdcm::TransferSyntax &syntax) {
    std::string name = syntax.GetString();
    if (name.size() % 2) name.push_back(0);
    gdcm::DataElement element(gdcm::Tag(0x0002, 0x0010));
    element.SetVR(gdcm::VR::UI);
    element.SetByteValue(name.data(), static_cast<uint32_t>(name.size()));
    return element;
}

/* Changes only the pixels and the transfer syntax. GDCM's ImageWriter is not used because it would rewrite
 * the geometry. */
int dicom_compress(const char *path, const char *how) {
    gdcm::Trace::WarningOff(); /* warnings about elements that these small files do not have */
    gdcm::ImageReader reader;
    reader.SetFileName(path);
    if (!reader.Read()) return 1;
    gdcm::ImageChangeTransferSyntax change;
    const gdcm::TransferSyntax syntax(syntax_of(how));
    change.SetTransferSyntax(syntax);
    change.SetInput(reader.GetImage());
    if (!change.Change()) return 2;
    gdcm::File &file = reader.GetFile();
    file.GetDataSet().Replace(change.GetOutput().GetDataElement());
    file.GetHeader().SetDataSetTransferSyntax(syntax);
    file.GetHeader().Replace(transfer_syntax(syntax));
    gdcm::Writer writer;
    writer.SetFile(file);
    writer.SetFileName(path);
    writer.CheckFileMetaInformationOff();
    return writer.Write() ? 0 : 3;
}
