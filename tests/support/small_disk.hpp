// A disk of a few hundred kilobytes that a test may fill, remount and nail names down on.
#pragma once

#include <fcntl.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/statfs.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "tests/support/scratch_dir.hpp"

namespace twinchute::test {

/// Why this process cannot mount, or nothing. The first call moves the process into a mount namespace of its
/// own, as root or as the root of a user namespace: nobody else sees the mounts, and they are gone with
/// the process however it ends.
inline const std::string& why_no_mounts() {
    static const std::string why = []() -> std::string {
        const auto user = ::getuid();
        const auto group = ::getgid();
        if (::unshare(CLONE_NEWNS) != 0) {
            if (::unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0)
                return std::string("no mount namespace: ") + std::strerror(errno);
            std::ofstream("/proc/self/setgroups") << "deny";
            std::ofstream("/proc/self/uid_map") << "0 " << user << " 1";
            std::ofstream("/proc/self/gid_map") << "0 " << group << " 1";
        }
        if (::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0)
            return std::string("mounts would not stay private: ") + std::strerror(errno);
        return "";
    }();
    return why;
}

/// A tmpfs of this test's own. Where nothing can be mounted (most containers), /dev/shm will do if it is a
/// tmpfs too small to be missed: the ballast below fills it just as well.
class SmallDisk {
public:
    explicit SmallDisk(const std::string& options = "size=8m") {
        path_ = place_.path();
        if (!why_no_mounts().empty()) {
            why_ = why_no_mounts();
        } else if (::mount("tmpfs", path_.c_str(), "tmpfs", 0, options.c_str()) != 0) {
            why_ = std::string("no tmpfs: ") + std::strerror(errno);
        } else {
            mounted_ = true;
        }
    }
    ~SmallDisk() {
        std::error_code ignored;
        if (mounted_) {
            ::umount2(path_.c_str(), MNT_DETACH);
        } else if (path_ != place_.path()) {
            std::filesystem::remove_all(path_, ignored);
        }
    }
    SmallDisk(const SmallDisk&) = delete;
    SmallDisk& operator=(const SmallDisk&) = delete;

    bool mounted() const { return mounted_; }
    /// Why it is not mounted.
    const std::string& why() const { return why_; }
    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

    /// Uses /dev/shm instead of a mount. False where that is not a small tmpfs.
    bool borrow_shared_memory() {
        struct statfs kind {};
        struct statvfs size {};
        constexpr auto tmpfs = 0x01021994;
        if (::statfs("/dev/shm", &kind) != 0 || kind.f_type != tmpfs) return false;
        if (::statvfs("/dev/shm", &size) != 0 || size.f_blocks * size.f_frsize > (128u << 20)) return false;
        std::string name = "/dev/shm/twinchute-test-XXXXXX";
        if (::mkdtemp(name.data()) == nullptr) return false;
        path_ = name;
        return true;
    }

    /// Fills the disk until this many bytes are left.
    void leave(std::size_t bytes) {
        const std::filesystem::path file = path_ / "ballast";
        std::error_code ignored;
        std::filesystem::remove(file, ignored);
        struct statvfs size {};
        ::statvfs(path_.c_str(), &size);
        const std::size_t room = size.f_bavail * size.f_frsize;
        if (room <= bytes) return;
        const int fd = ::open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
        const int error = fd < 0 ? errno : ::posix_fallocate(fd, 0, static_cast<off_t>(room - bytes));
        if (fd >= 0) ::close(fd);
        if (error != 0) throw std::runtime_error(std::string("no ballast: ") + std::strerror(error));
    }

    void make_read_only() {
        if (::mount(nullptr, path_.c_str(), nullptr, MS_REMOUNT | MS_RDONLY, nullptr) != 0)
            throw std::runtime_error(std::string("cannot remount: ") + std::strerror(errno));
    }

    /// Makes a file a mount point: its name can be neither removed nor given to another file (EBUSY).
    static void nail_down(const std::filesystem::path& file) {
        if (::mount(file.c_str(), file.c_str(), nullptr, MS_BIND, nullptr) != 0)
            throw std::runtime_error(std::string("cannot bind: ") + std::strerror(errno));
    }

private:
    ScratchDir place_;
    std::filesystem::path path_;
    std::string why_;
    bool mounted_ = false;
};

}  // namespace twinchute::test
