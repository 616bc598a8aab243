/* exr_files: OpenEXR pictures with OpenEXR's C++ library. */
#include "exr_files.h"

#include <vector>

#include <ImfArray.h>
#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfMatrixAttribute.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <ImfTiledOutputFile.h>

namespace {

template <class F> int guarded(F &&body) {
    try {
        return body() ? 0 : 1;
    } catch (...) {
        return 1;
    }
}

Imf::PixelType type_of(const exr_picture &picture) {
    return picture.integers ? Imf::UINT : picture.half ? Imf::HALF : Imf::FLOAT;
}

/* Stores a value in the type of the file; each pixel has 4 bytes, whatever the type. */
void store(const exr_picture &picture, float value, char *to) {
    if (picture.integers)
        *reinterpret_cast<unsigned *>(to) = static_cast<unsigned>(value);
    else if (picture.half)
        *reinterpret_cast<half *>(to) = half(value);
    else
        *reinterpret_cast<float *>(to) = value;
}

template <class T> const T *attribute(const Imf::InputFile &file, const char *name) {
    return file.header().findTypedAttribute<T>(name);
}

} // namespace

int exr_write(const char *path, const exr_picture *picture) {
    return guarded([&] {
        const exr_picture &p = *picture;
        Imath::Box2i window(Imath::V2i(p.min_x, p.min_y),
                            Imath::V2i(p.min_x + p.width - 1, p.min_y + p.height - 1));
        Imf::Header header(window, window, 1, Imath::V2f(0, 0), 1, Imf::INCREASING_Y,
                           static_cast<Imf::Compression>(p.compression));
        int step = p.subsampled ? p.subsampled : 1;
        std::vector<std::vector<char>> planes;
        Imf::FrameBuffer buffer;
        for (int c = 0; c < EXR_PICTURE_CHANNELS + 1 && p.names[c]; c++) {
            planes.emplace_back(size_t(p.width) * p.height * 4);
            for (int y = 0; y < p.height; y++)
                for (int x = 0; x < p.width; x++)
                    store(p, p.value(c, x, y), &planes.back()[(size_t(y) * p.width + x) * 4]);
            size_t row = size_t(p.width) * 4;
            char *origin = planes.back().data() - p.min_x * 4 - p.min_y * ptrdiff_t(row);
            header.channels().insert(p.names[c], Imf::Channel(type_of(p), step, step));
            buffer.insert(p.names[c], Imf::Slice(type_of(p), origin, 4, row, step, step));
        }
        if (p.tiled) {
            header.setTileDescription(Imf::TileDescription(16, 16));
            Imf::TiledOutputFile file(path, header);
            file.setFrameBuffer(buffer);
            file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
        } else {
            Imf::OutputFile file(path, header);
            file.setFrameBuffer(buffer);
            file.writePixels(p.height);
        }
        return true;
    });
}

/* Reads a channel of values of 4 bytes; false unless it has the given type and size. */
static bool read_channel(const char *path, const char *channel, Imf::PixelType type, int width, int height,
                         void *values) {
    Imf::InputFile file(path);
    const Imath::Box2i window = file.header().dataWindow();
    const Imf::Channel *found = file.header().channels().findChannel(channel);
    if (window.min != Imath::V2i(0, 0) || window.max != Imath::V2i(width - 1, height - 1)) return false;
    if (!found || found->type != type) return false;
    Imf::FrameBuffer buffer;
    buffer.insert(channel, Imf::Slice(type, static_cast<char *>(values), 4, size_t(width) * 4));
    file.setFrameBuffer(buffer);
    file.readPixels(0, height - 1);
    return file.isComplete();
}

int exr_read(const char *path, const char *channel, int width, int height, float *values) {
    return guarded([&] { return read_channel(path, channel, Imf::FLOAT, width, height, values); });
}

int exr_read_integers(const char *path, const char *channel, int width, int height, unsigned *values) {
    return guarded([&] { return read_channel(path, channel, Imf::UINT, width, height, values); });
}

int exr_read_matrix(const char *path, const char *name, float matrix[16]) {
    return guarded([&] {
        Imf::InputFile file(path);
        const auto *found = attribute<Imf::M44fAttribute>(file, name);
        for (int i = 0; found && i < 16; i++) matrix[i] = found->value()[i / 4][i % 4];
        return found != nullptr;
    });
}

int exr_read_float(const char *path, const char *name, float *value) {
    return guarded([&] {
        Imf::InputFile file(path);
        const auto *found = attribute<Imf::FloatAttribute>(file, name);
        if (found) *value = found->value();
        return found != nullptr;
    });
}

int exr_has_text(const char *path, const char *name, const char *text) {
    return guarded([&] {
        Imf::InputFile file(path);
        const auto *found = attribute<Imf::StringAttribute>(file, name);
        return found && found->value() == text;
    });
}
