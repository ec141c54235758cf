// SPDX-License-Identifier: MIT
#include "encoded.hpp"

#include <turbojpeg.h>

#include <memory>

namespace gnomon::app {

std::string jpeg_of(const Frame& frame, bool is_draft) {
    const std::unique_ptr<void, int (*)(tjhandle)> encoder(tjInitCompress(), tjDestroy);
    if (!encoder) throw Error(std::string("libjpeg-turbo: ") + tjGetErrorStr());
    const int sampling = is_draft ? TJSAMP_420 : TJSAMP_444, quality = is_draft ? 80 : 92;
    std::string jpeg(tjBufSize(int(frame.width), int(frame.height), sampling), '\0');
    auto* bytes = reinterpret_cast<unsigned char*>(jpeg.data());
    unsigned long size = jpeg.size();
    if (tjCompress2(encoder.get(), frame.rgba.data(), int(frame.width), 0, int(frame.height), TJPF_RGBX, &bytes, &size,
                    sampling, quality, TJFLAG_NOREALLOC) != 0)
        throw Error(std::string("libjpeg-turbo: ") + tjGetErrorStr2(encoder.get()));
    jpeg.resize(size);
    return jpeg;
}

}  // namespace gnomon::app
