#include "study/campaign/store.hpp"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "lib/cli/command.hpp"
#include "lib/math/sha256.hpp"
#include "lib/record/file_batch.hpp"
#include "lib/record/record_json.hpp"

namespace twinchute::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

/// HDF5 of Debian knows no threads.
std::mutex& hdf5_lock() {
    static std::mutex lock;
    return lock;
}

/// A handle of HDF5 with its own way to be closed.
class Handle {
public:
    Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {
        if (id_ < 0) throw std::runtime_error("HDF5 refused");
    }
    ~Handle() {
        if (close_) close_(id_);
    }
    Handle(Handle&& other) noexcept : id_(other.id_), close_(std::exchange(other.close_, nullptr)) {}
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    operator hid_t() const { return id_; }

private:
    hid_t id_;
    herr_t (*close_)(hid_t);
};

void require(herr_t code) {
    if (code < 0) throw std::runtime_error("HDF5 failed");
}

/// Nothing that says when a file was made.
Handle without_times(hid_t list_class) {
    Handle list(H5Pcreate(list_class), H5Pclose);
    require(H5Pset_obj_track_times(list, 0));
    return list;
}

/// A file in memory.
Handle memory_access(std::string_view image = {}) {
    constexpr std::size_t growth = 1u << 16;
    Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    require(H5Pset_fapl_core(access, growth, 0));
    if (!image.empty()) require(H5Pset_file_image(access, const_cast<char*>(image.data()), image.size()));
    return access;
}

std::string image_of(hid_t file) {
    require(H5Fflush(file, H5F_SCOPE_GLOBAL));
    const ssize_t size = H5Fget_file_image(file, nullptr, 0);
    if (size < 0) throw std::runtime_error("HDF5 gave no image");
    std::string bytes(static_cast<std::size_t>(size), '\0');
    if (H5Fget_file_image(file, bytes.data(), bytes.size()) != size)
        throw std::runtime_error("HDF5 gave no image");
    return bytes;
}

void add_texts(hid_t to, const char* name, const std::vector<std::string>& texts) {
    std::size_t longest = 1;
    for (const std::string& text : texts)
        longest = std::max(longest, text.size());
    const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
    require(H5Tset_size(type, longest));
    require(H5Tset_strpad(type, H5T_STR_NULLPAD));
    const hsize_t count = texts.size();
    const Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
    const Handle attribute(H5Acreate2(to, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    std::string packed(longest * texts.size(), '\0');
    for (std::size_t i = 0; i < texts.size(); ++i)
        std::ranges::copy(texts[i], packed.begin() + static_cast<std::ptrdiff_t>(i * longest));
    require(H5Awrite(attribute, type, packed.data()));
}

void add_number(hid_t to, const char* name, std::uint64_t number) {
    const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
    const Handle attribute(H5Acreate2(to, name, H5T_STD_U64LE, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    require(H5Awrite(attribute, H5T_NATIVE_UINT64, &number));
}

void describe(hid_t dataset, const StoreIdentity& identity) {
    add_texts(dataset, "columns", identity.columns);
    add_texts(dataset, "units", identity.units);
    add_texts(dataset, "statuses", identity.statuses);
    add_texts(dataset, "digest", {identity.digest});
    add_number(dataset, "seed", identity.seed);
}

std::string text_attribute(hid_t of, const char* name) {
    if (H5Aexists(of, name) <= 0) return {};
    const Handle attribute(H5Aopen(of, name, H5P_DEFAULT), H5Aclose);
    const Handle type(H5Aget_type(attribute), H5Tclose);
    const Handle space(H5Aget_space(attribute), H5Sclose);
    if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0) return {};
    if (H5Sget_simple_extent_npoints(space) != 1) return {};
    std::string text(H5Tget_size(type), '\0');
    require(H5Aread(attribute, type, text.data()));
    return text.substr(0, text.find('\0'));
}

std::optional<std::uint64_t> number_attribute(hid_t of, const char* name) {
    if (H5Aexists(of, name) <= 0) return {};
    const Handle attribute(H5Aopen(of, name, H5P_DEFAULT), H5Aclose);
    const Handle space(H5Aget_space(attribute), H5Sclose);
    if (H5Sget_simple_extent_npoints(space) != 1) return {};
    std::uint64_t number = 0;
    require(H5Aread(attribute, H5T_NATIVE_UINT64, &number));
    return number;
}

std::string digest_of(std::span<const double> rows) {
    return sha256_hex({reinterpret_cast<const char*>(rows.data()), rows.size_bytes()});
}

std::string chunk_bytes(const StoreIdentity& identity, std::uint64_t first, std::span<const double> rows) {
    const Handle access = memory_access(), creation = without_times(H5P_FILE_CREATE);
    const Handle file(H5Fcreate("chunk", H5F_ACC_TRUNC, creation, access), H5Fclose);
    const hsize_t size[] = {rows.size() / identity.columns.size(), identity.columns.size()};
    const Handle space(H5Screate_simple(2, size, nullptr), H5Sclose);
    const Handle list = without_times(H5P_DATASET_CREATE);
    const Handle data(H5Dcreate2(file, "runs", H5T_IEEE_F64LE, space, H5P_DEFAULT, list, H5P_DEFAULT),
                      H5Dclose);
    require(H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, rows.data()));
    describe(data, identity);
    add_number(data, "first_run", first);
    add_texts(data, "sha256", {digest_of(rows)});
    return image_of(file);
}

/// Empty where the bytes are no chunk of this campaign.
RunStore::Rows chunk_rows(const StoreIdentity& identity, std::uint64_t first, std::string_view bytes) {
    const Handle access = memory_access(bytes);
    const Handle file(H5Fopen("chunk", H5F_ACC_RDONLY, access), H5Fclose);
    const Handle data(H5Dopen2(file, "runs", H5P_DEFAULT), H5Dclose);
    if (text_attribute(data, "digest") != identity.digest) return {};
    if (number_attribute(data, "first_run") != first || number_attribute(data, "seed") != identity.seed)
        return {};
    const Handle space(H5Dget_space(data), H5Sclose);
    hsize_t size[2] = {};
    if (H5Sget_simple_extent_ndims(space) != 2 || H5Sget_simple_extent_dims(space, size, nullptr) != 2)
        return {};
    if (size[1] != identity.columns.size() || size[0] > identity.chunk) return {};
    RunStore::Rows rows(size[0] * size[1]);
    require(H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, rows.data()));
    if (text_attribute(data, "sha256") != digest_of(rows)) return {};
    return rows;
}

/// Its messages about what is wrong with a file go nowhere: the caller says it.
void be_quiet() {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

std::string whole_file(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary | std::ios::ate);
    if (!stream) return {};
    std::string bytes(static_cast<std::size_t>(stream.tellg()), '\0');
    stream.seekg(0);
    stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return stream ? bytes : std::string();
}

ordered_json identity_json(const StoreIdentity& identity) {
    return {{"schema", 1},
            {"generator", "twinchute"},
            {"program", identity.program},
            {"digest", identity.digest},
            {"seed", identity.seed},
            {"chunk", identity.chunk},
            {"columns", identity.columns},
            {"units", identity.units},
            {"statuses", identity.statuses}};
}

}  // namespace

fs::path store_file(const fs::path& directory) {
    return directory / "store.json";
}

bool RunStore::exists() const {
    std::error_code ignored;
    return fs::exists(store_file(directory_), ignored);
}

void RunStore::require_same() const {
    const fs::path file = store_file(directory_);
    const auto refuse = [&](const char* what) {
        throw UsageError(
            fmt::format("'{}' holds runs of another campaign ({} differs), name another directory "
                        "with --out",
                        directory_.string(), what));
    };
    const auto json = ordered_json::parse(whole_file(file), nullptr, false);
    const ordered_json wanted = identity_json(identity_);
    if (!json.is_object()) refuse("store.json is damaged, all");
    constexpr std::pair<const char*, const char*> parts[] = {
        {"seed", "the seed"},
        {"digest", "the scene, an input, the design or the fidelity"},
        {"columns", "the metrics that are kept"},
        {"chunk", "the size of chunks"},
        {"program", "the version of twinchute"}};
    for (const auto& [key, words] : parts)
        if (!json.contains(key) || json[key] != wanted[key]) refuse(words);
}

void RunStore::begin() const {
    std::error_code error;
    fs::create_directories(folder(), error);
    if (error) throw WriteError(folder(), error.value());
    if (!exists()) replace_file(store_file(directory_), json_text(identity_json(identity_)));
}

fs::path RunStore::folder() const {
    return directory_ / "runs";
}

fs::path RunStore::file_of(std::uint64_t chunk) const {
    return folder() / fmt::format("chunk-{:08}.h5", chunk);
}

std::uint64_t RunStore::rows_of(std::uint64_t chunk, std::uint64_t runs) const {
    return std::min(identity_.chunk, runs - chunk * identity_.chunk);
}

RunStore::Rows RunStore::read(std::uint64_t chunk, std::uint64_t rows) const {
    const std::string bytes = whole_file(file_of(chunk));
    if (bytes.empty()) return {};
    const std::scoped_lock lock(hdf5_lock());
    be_quiet();
    try {
        Rows found = chunk_rows(identity_, chunk * identity_.chunk, bytes);
        if (found.size() < rows * columns()) return {};
        found.resize(rows * columns());
        return found;
    } catch (const std::runtime_error&) {
        return {};  // not what was written: it is made again
    }
}

bool RunStore::has(std::uint64_t chunk, std::uint64_t rows) const {
    return !read(chunk, rows).empty();
}

void RunStore::write(std::uint64_t chunk, std::span<const double> rows) const {
    std::string bytes;
    {
        const std::scoped_lock lock(hdf5_lock());
        be_quiet();
        bytes = chunk_bytes(identity_, chunk * identity_.chunk, rows);
    }
    replace_file(file_of(chunk), bytes);
}

void RunStore::join(std::uint64_t runs) const {
    std::string bytes;
    {
        const std::scoped_lock lock(hdf5_lock());
        be_quiet();
        const Handle access = memory_access(), creation = without_times(H5P_FILE_CREATE);
        const Handle file(H5Fcreate("all", H5F_ACC_TRUNC, creation, access), H5Fclose);
        const hsize_t size[] = {runs, columns()};
        const Handle space(H5Screate_simple(2, size, nullptr), H5Sclose);
        const Handle list = without_times(H5P_DATASET_CREATE);
        constexpr double missing = std::numeric_limits<double>::quiet_NaN();
        require(H5Pset_fill_value(list, H5T_NATIVE_DOUBLE, &missing));
        for (std::uint64_t chunk = 0; chunk < chunks_of(runs); ++chunk) {
            const hsize_t from[] = {chunk * identity_.chunk, 0}, part[] = {rows_of(chunk, runs), columns()};
            require(H5Sselect_hyperslab(space, H5S_SELECT_SET, from, nullptr, part, nullptr));
            const Handle source(H5Screate_simple(2, part, nullptr), H5Sclose);
            const std::string name = (fs::path("runs") / file_of(chunk).filename()).string();
            require(H5Pset_virtual(list, space, name.c_str(), "runs", source));
        }
        require(H5Sselect_all(space));
        const Handle data(H5Dcreate2(file, "runs", H5T_IEEE_F64LE, space, H5P_DEFAULT, list, H5P_DEFAULT),
                          H5Dclose);
        describe(data, identity_);
        bytes = image_of(file);
    }
    replace_file(joined_file(), bytes);
}

}  // namespace twinchute::study
