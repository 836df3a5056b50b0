#include "lib/exchange/packed_file.hpp"

#include <fmt/format.h>
#include <minizip/unzip.h>
#include <zlib.h>

#include <algorithm>
#include <memory>

#include "lib/scene/data_files.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute::exchange {
namespace {

[[noreturn]] void refuse_packed(const std::filesystem::path& file, std::string problem, std::string why,
                                std::string hint) {
    throw SceneError({file.string(), 0, 0}, "", std::move(problem), std::move(why), std::move(hint));
}

[[noreturn]] void refuse_size(const std::filesystem::path& file) {
    refuse_packed(file, "holds too much",
                  fmt::format("more than {} MiB once unpacked", largest_unpacked >> 20),
                  "save it without the data of its simulations");
}

constexpr const char* save_again = "save it again in the program that wrote it";

/// Content of a gzip file.
std::string gunzip(const std::string& packed, const std::filesystem::path& file) {
    z_stream stream{};
    if (inflateInit2(&stream, 16 + MAX_WBITS) != Z_OK)  // 16: gzip's head and check sum
        refuse_packed(file, "cannot be unpacked", "no memory", "close other programs");
    const std::unique_ptr<z_stream, int (*)(z_streamp)> owner(&stream, &inflateEnd);
    std::string in = packed, text;
    stream.next_in = reinterpret_cast<Bytef*>(in.data());
    stream.avail_in = static_cast<uInt>(in.size());
    std::string buffer(1u << 16, '\0');
    for (int code = Z_OK; code != Z_STREAM_END;) {
        stream.next_out = reinterpret_cast<Bytef*>(buffer.data());
        stream.avail_out = static_cast<uInt>(buffer.size());
        code = inflate(&stream, Z_NO_FLUSH);
        const std::size_t got = buffer.size() - stream.avail_out;
        if ((code != Z_OK && code != Z_STREAM_END) || (code == Z_OK && got == 0))
            refuse_packed(file, "is damaged", "its gzip data end early or are not gzip's", save_again);
        if (text.size() + got > largest_unpacked) refuse_size(file);
        text.append(buffer, 0, got);
    }
    return text;
}

/// The first member of a zip archive whose name ends so.
std::string unzip(const std::filesystem::path& file, std::string_view member) {
    const std::unique_ptr<void, int (*)(unzFile)> zip(unzOpen64(file.c_str()), &unzClose);
    if (!zip) refuse_packed(file, "is damaged", "its zip archive has no directory", save_again);
    for (int code = unzGoToFirstFile(zip.get()); code == UNZ_OK; code = unzGoToNextFile(zip.get())) {
        unz_file_info64 info{};
        std::string name(256, '\0');
        if (unzGetCurrentFileInfo64(zip.get(), &info, name.data(), name.size(), nullptr, 0, nullptr, 0) !=
            UNZ_OK)
            break;
        name.resize(std::min<std::size_t>(info.size_filename, name.size()));
        if (!name.ends_with(member)) continue;
        if (info.uncompressed_size > largest_unpacked) refuse_size(file);
        if (info.flag & 1)
            refuse_packed(file, fmt::format("'{}' in it is encrypted", member), "",
                          "save it without a password");
        if (unzOpenCurrentFile(zip.get()) != UNZ_OK)
            refuse_packed(file, "cannot be unpacked", "its compression is unknown or damaged", save_again);
        std::string text, buffer(1u << 16, '\0');
        int got = 0;
        while ((got = unzReadCurrentFile(zip.get(), buffer.data(), static_cast<unsigned>(buffer.size()))) >
               0) {
            if (text.size() + static_cast<std::size_t>(got) > largest_unpacked) refuse_size(file);
            text.append(buffer, 0, static_cast<std::size_t>(got));
        }
        // The check sum is known once all has been read.
        if (unzCloseCurrentFile(zip.get()) != UNZ_OK || got < 0 || text.size() != info.uncompressed_size)
            refuse_packed(file, "is damaged", fmt::format("'{}' in it does not match its check sum", member),
                          save_again);
        return text;
    }
    refuse_packed(file, fmt::format("has no '*{}' in it", member),
                  "a zip archive of an OpenRocket design holds rocket.ork", "name a design");
}

}  // namespace

std::string read_packed_file(const std::filesystem::path& file, std::string_view member) {
    const std::string text = read_text_file(file, largest_packed);
    if (text.starts_with("PK\x03\x04") || text.starts_with("PK\x05\x06")) return unzip(file, member);
    if (text.starts_with("\x1f\x8b")) return gunzip(text, file);
    return text;
}

}  // namespace twinchute::exchange
