/* decode: decodes the compressed pixels of a DICOM frame with GDCM's codecs (JPEG, JPEG-LS, JPEG 2000, RLE).
 *
 * GDCM is given an image in memory instead of the file, because its parser asserts on files that header.c
 * rejects. */
#include "grids/volume/dicom/dicom.h"

#include <cstdio>
#include <cstring>
#include <mutex>
#include <string>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <gdcmByteValue.h>
#include <gdcmImage.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmTrace.h>
#include <gdcmTransferSyntax.h>

#include "base/bridge_guard.hpp"
#include "grids/volume/module.h"

namespace {

/* Catches what is written to standard error while it lives. GDCM's own messages can be turned off, but its
 * codecs (libjpeg, OpenJPEG) write theirs without asking. Standard error belongs to the whole process: lines
 * of other threads are caught, too, during the milliseconds that a frame takes. */
class caught_messages {
    static std::mutex lock;
    const std::lock_guard<std::mutex> alone{lock};
    const int messages = memfd_create("messages of a codec", MFD_CLOEXEC);
    int kept = -1;

  public:
    caught_messages() {
        gdcm::Trace::DebugOff();
        gdcm::Trace::WarningOff();
        gdcm::Trace::ErrorOff();
        std::fflush(stderr);
        if (messages >= 0) kept = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
        if (kept >= 0) dup2(messages, STDERR_FILENO);
    }
    ~caught_messages() {
        std::fflush(stderr);
        if (kept >= 0) dup2(kept, STDERR_FILENO);
        if (kept >= 0) close(kept);
        if (messages >= 0) close(messages);
    }
    caught_messages(const caught_messages &) = delete;
    caught_messages &operator=(const caught_messages &) = delete;

    /* The first line so far; empty if there is none. */
    std::string first_line() const {
        char text[200];
        std::fflush(stderr);
        const ssize_t length = messages < 0 ? 0 : pread(messages, text, sizeof text, 0);
        std::string line(text, length > 0 ? static_cast<size_t>(length) : 0);
        return iso::one_line(line.substr(0, line.find('\n')));
    }
};

std::mutex caught_messages::lock;

gdcm::DataElement pixels_of(const iso_dicom_items &items) {
    gdcm::SmartPointer<gdcm::SequenceOfFragments> sequence = new gdcm::SequenceOfFragments;
    for (size_t i = 0; i < items.count; i++) {
        gdcm::Fragment fragment;
        fragment.SetByteValue(reinterpret_cast<const char *>(items.bytes + items.offset[i]),
                              static_cast<uint32_t>(items.length[i]));
        sequence->AddFragment(fragment);
    }
    gdcm::DataElement pixels(gdcm::Tag(0x7fe0, 0x0010));
    pixels.SetVR(gdcm::VR::OB);
    pixels.SetValue(*sequence);
    return pixels;
}

iso_status decode(const iso_dicom_file &file, const iso_dicom_items &items, void *pixels, iso_error *error) {
    const gdcm::TransferSyntax syntax(gdcm::TransferSyntax::GetTSType(file.syntax));
    if (syntax == gdcm::TransferSyntax::TS_END)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: its compression (transfer syntax %s) is not known",
                        file.path, file.syntax);
    if (!iso_dicom_codestream_fits(&file, items.bytes + items.offset[0], items.length[0]))
        return iso_fail(error, ISO_ERR_IO, "%s: corrupt: its compressed pixels are not what its header says",
                        file.path);
    std::memset(pixels, 0,
                iso_dicom_frame_bytes(&file)); /* after the checks: a wrong size can be gigabytes */
    gdcm::Image image;
    image.SetTransferSyntax(syntax);
    image.SetNumberOfDimensions(2);
    image.SetDimension(0, static_cast<unsigned>(file.columns));
    image.SetDimension(1, static_cast<unsigned>(file.rows));
    const auto narrow = [](int value) { return static_cast<unsigned short>(value); };
    const gdcm::PixelFormat format(narrow(file.samples), narrow(file.bits_allocated),
                                   narrow(file.bits_stored), narrow(file.high_bit), file.is_signed);
    image.SetPixelFormat(format);
    image.SetPhotometricInterpretation(gdcm::PhotometricInterpretation::MONOCHROME2);
    image.SetDataElement(pixels_of(items));
    const uint64_t wanted = iso_dicom_frame_bytes(&file);
    if (image.GetBufferLength() != wanted || !image.GetBuffer(static_cast<char *>(pixels)))
        return iso_fail(error, ISO_ERR_IO, "%s: its compressed pixels cannot be decoded", file.path);
    if (image.GetPixelFormat().GetBitsAllocated() != file.bits_allocated)
        return iso_fail(error, ISO_ERR_IO,
                        "%s: its compressed pixels have another depth than its header says", file.path);
    return ISO_OK;
}

iso_status decode_frame(const iso_dicom_file *file, const iso_dicom_items *items, void *pixels,
                        char warning[ISO_DICOM_WARNING], iso_error *error) {
    return iso::guard(file->path, error, [&] {
        const caught_messages messages;
        iso_error detail = {};
        const iso_status status = decode(*file, *items, pixels, &detail);
        const std::string line = messages.first_line();
        std::snprintf(warning, ISO_DICOM_WARNING, "%s", line.c_str());
        if (status == ISO_OK) return status;
        if (line.empty()) return iso_fail(error, status, "%s", detail.text);
        return iso_fail(error, status, "%s (%s)", detail.text, warning);
    });
}

} // namespace

ISO_MODULE(nullptr, decode_frame, nullptr, nullptr, nullptr);
