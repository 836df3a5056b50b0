#include "lib/record/file_batch.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <set>
#include <string>
#include <system_error>

namespace twinchute {
namespace {

namespace fs = std::filesystem;

std::string say(const fs::path& path, const std::string& reason) {
    return fmt::format("cannot write '{}' ({}), choose another place with --out or make room there",
                       path.string(), reason);
}

fs::path parent_of(const fs::path& target) {
    return target.has_parent_path() ? target.parent_path() : fs::path(".");
}

/// A file descriptor that closes itself; close() reports what the kernel held back until then.
class Descriptor {
public:
    explicit Descriptor(int fd) : fd_(fd) {}
    ~Descriptor() {
        if (fd_ >= 0) ::close(fd_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;

    int get() const { return fd_; }
    bool close() {
        const int fd = fd_;
        fd_ = -1;
        return ::close(fd) == 0;
    }

private:
    int fd_;
};

/// A name beside the target that starts with a dot and that no other process has.
fs::path temporary_name(const fs::path& target) {
    static std::atomic<unsigned> count = 0;
    return parent_of(target) /
           fmt::format(".{}.{}-{}.tmp", target.filename().string(), ::getpid(), count.fetch_add(1));
}

/// Opens a new file beside the target.
int open_temporary(const fs::path& target, fs::path& temporary) {
    for (;;) {
        temporary = temporary_name(target);
        const int fd = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (fd >= 0 || errno != EEXIST) return fd;
    }
}

/// 0, or the error number of the step that failed.
int write_all(Descriptor& file, std::string_view text) {
    while (!text.empty()) {
        const ssize_t written = ::write(file.get(), text.data(), text.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return errno;
        if (written == 0) return ENOSPC;
        text.remove_prefix(static_cast<std::size_t>(written));
    }
    if (::fsync(file.get()) != 0) return errno;
    return file.close() ? 0 : errno;
}

/// Makes renames durable. Some file systems refuse to sync a directory; the data are safe by then.
void sync_directory(const fs::path& directory) {
    const Descriptor handle(::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (handle.get() >= 0) ::fsync(handle.get());
}

/// Where an old file waits while the new ones take their places.
fs::path aside_of(const fs::path& temporary) {
    fs::path aside = temporary;
    aside += ".old";
    return aside;
}

/// Renames that are taken back, last one first, unless all of them succeeded: one name that cannot be
/// replaced (immutable, another user's file in a sticky directory) must not cost the results beside it.
class Renames {
public:
    Renames() = default;
    ~Renames() {
        for (auto step = done_.rbegin(); step != done_.rend(); ++step)
            ::rename(step->to.c_str(), step->from.c_str());
    }
    Renames(const Renames&) = delete;
    Renames& operator=(const Renames&) = delete;

    /// Moves an old file out of the way; there may be none. Throws WriteError.
    void set_aside(const fs::path& target, const fs::path& aside) {
        std::error_code ignored;
        if (fs::is_directory(fs::symlink_status(target, ignored))) throw WriteError(target, EISDIR);
        if (::rename(target.c_str(), aside.c_str()) == 0) {
            done_.push_back({target, aside});
        } else if (errno != ENOENT) {
            throw WriteError(target, errno);
        }
    }

    /// Gives a temporary file its name. Throws WriteError.
    void place(const fs::path& temporary, const fs::path& target) {
        if (::rename(temporary.c_str(), target.c_str()) != 0) throw WriteError(target, errno);
        done_.push_back({temporary, target});
    }

    void keep() { done_.clear(); }

private:
    struct Step {
        fs::path from, to;
    };
    std::vector<Step> done_;
};

}  // namespace

WriteError::WriteError(const fs::path& path, const std::string& reason)
    : std::runtime_error(say(path, reason)), path_(path) {}

WriteError::WriteError(const fs::path& path, int error_number)
    : WriteError(path, std::generic_category().message(error_number)) {}

FileBatch::~FileBatch() {
    for (std::size_t i = spared_; i < pending_.size(); ++i)
        ::unlink(pending_[i].temporary.c_str());
    for (auto directory = made_.rbegin(); directory != made_.rend(); ++directory) {
        ::rmdir(directory->c_str());  // stays when something is in it
    }
}

void FileBatch::make_directories(const fs::path& directory) {
    std::error_code ignored;
    if (fs::is_directory(directory, ignored)) return;
    if (directory.has_parent_path() && directory.parent_path() != directory) {
        make_directories(directory.parent_path());
    }
    if (::mkdir(directory.c_str(), 0777) == 0) {
        made_.push_back(directory);
    } else if (const int error = errno; !fs::is_directory(directory, ignored)) {
        throw WriteError(directory, error);
    }
}

fs::path FileBatch::add(const fs::path& target, std::string_view text, Kind kind) {
    make_directories(parent_of(target));
    std::error_code ignored;
    if (fs::is_directory(target, ignored)) throw WriteError(target, EISDIR);

    fs::path temporary;
    Descriptor file(open_temporary(target, temporary));
    if (file.get() < 0) throw WriteError(target, errno);
    pending_.push_back({target, temporary, kind});
    if (const int error = write_all(file, text); error != 0) throw WriteError(target, error);
    return temporary;
}

void FileBatch::adopt(const fs::path& target, const fs::path& temporary) {
    pending_.push_back({target, temporary, Kind::content});
}

void FileBatch::drop(const fs::path& target) {
    for (Pending& file : pending_)
        file.dropped = file.dropped || file.target == target;
}

void FileBatch::remove(const fs::path& target) {
    removals_.push_back({target, aside_of(temporary_name(target))});
}

void FileBatch::commit() {
    Renames renames;
    std::set<fs::path> directories;
    // Markers first: what stands in their directories from here on is not a record.
    for (const Kind kind : {Kind::marker, Kind::content}) {
        for (const Pending& file : pending_) {
            if (file.kind == kind && !file.dropped) renames.set_aside(file.target, aside_of(file.temporary));
            directories.insert(parent_of(file.target));
        }
    }
    for (const Removal& file : removals_)
        renames.set_aside(file.target, file.aside);
    for (const Kind kind : {Kind::content, Kind::marker}) {
        for (const Pending& file : pending_) {
            if (file.kind == kind && !file.dropped) renames.place(file.temporary, file.target);
        }
        // A marker must not reach the disk before the contents whose checksums it holds.
        for (const fs::path& directory : directories)
            sync_directory(directory);
    }
    renames.keep();
    for (const Pending& file : pending_)
        ::unlink(file.dropped ? file.temporary.c_str() : aside_of(file.temporary).c_str());
    for (const Removal& file : removals_) {
        if (::unlink(file.aside.c_str()) == 0)
            ::rmdir(parent_of(file.target).c_str());  // stays when something is in it
    }
    pending_.clear();
    spared_ = 0;
    removals_.clear();
    made_.clear();
}

void replace_file(const fs::path& target, std::string_view text) {
    fs::path temporary;
    Descriptor file(open_temporary(target, temporary));
    if (file.get() < 0) throw WriteError(target, errno);
    int error = write_all(file, text);
    if (error == 0 && ::rename(temporary.c_str(), target.c_str()) != 0) error = errno;
    if (error != 0) {
        ::unlink(temporary.c_str());
        throw WriteError(target, error);
    }
    sync_directory(parent_of(target));
}

bool is_abandoned(const fs::path& file) {
    std::string name = file.filename().string();
    if (name.ends_with(".old")) name.resize(name.size() - 4);
    if (!name.starts_with('.') || !name.ends_with(".tmp")) return false;
    name.resize(name.size() - 4);
    const std::size_t dot = name.rfind('.');  // before "<process>-<count>"
    if (dot == 0 || dot == std::string::npos) return false;
    pid_t process = 0;
    unsigned count = 0;
    const char *begin = name.data() + dot + 1, *const end = name.data() + name.size();
    const auto [dash, no_process] = std::from_chars(begin, end, process);
    if (no_process != std::errc{} || dash == end || *dash != '-') return false;
    const auto [rest, no_count] = std::from_chars(dash + 1, end, count);
    if (no_count != std::errc{} || rest != end || process <= 0) return false;
    return process != ::getpid() && ::kill(process, 0) != 0 && errno == ESRCH;
}

}  // namespace twinchute
