// A program that is killed just before it changes the file system for the nth time.
#pragma once

#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/wait.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/process.hpp"

namespace twinchute::test {

/// True for the system calls by which results are written: they make, fill, flush, rename or remove.
inline bool changes_files(const __ptrace_syscall_info& call) {
    const auto is = [&](long number) { return call.entry.nr == static_cast<std::uint64_t>(number); };
    if (is(SYS_write)) return call.entry.args[0] > 2;  // not what is said on a terminal
    if (is(SYS_openat)) return (call.entry.args[2] & O_CREAT) != 0;
    bool one_of_them = is(SYS_fsync) || is(SYS_mkdirat) || is(SYS_unlinkat) || is(SYS_renameat2);
#ifdef SYS_rename  // calls that newer architectures do not have
    one_of_them = one_of_them || is(SYS_mkdir) || is(SYS_unlink) || is(SYS_rename) || is(SYS_rmdir);
    if (is(SYS_open)) return (call.entry.args[1] & O_CREAT) != 0;
#endif
#ifdef SYS_renameat
    one_of_them = one_of_them || is(SYS_renameat);
#endif
    return one_of_them;
}

enum class KilledAt { there, never, untraceable };

/// Runs a program and kills it (SIGKILL) before its nth change of a file, counted from 1. `never`: it ended
/// by itself before. `untraceable`: this machine lets no process trace another.
inline KilledAt kill_before_change(int n, const std::vector<std::string>& words,
                                   const std::filesystem::path& directory) {
    Process process(words, directory, {}, [] {
        ::setenv("ASAN_OPTIONS", "detect_leaks=0", 1);  // its leak search is a tracer too
        return ::ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) == 0;
    });
    const pid_t id = process.id();
    int status = 0;
    if (::waitpid(id, &status, 0) != id || !WIFSTOPPED(status)) return KilledAt::untraceable;
    ::ptrace(PTRACE_SETOPTIONS, id, nullptr, PTRACE_O_TRACESYSGOOD | PTRACE_O_EXITKILL);
    for (long signal = 0;;) {
        if (::ptrace(PTRACE_SYSCALL, id, nullptr, signal) != 0) return KilledAt::untraceable;
        if (::waitpid(id, &status, 0) != id || !WIFSTOPPED(status)) return KilledAt::never;
        signal = 0;
        if (WSTOPSIG(status) != (SIGTRAP | 0x80)) {  // a signal on its way, not a system call
            signal = WSTOPSIG(status) == SIGTRAP ? 0 : WSTOPSIG(status);
            continue;
        }
        __ptrace_syscall_info call{};
        if (::ptrace(PTRACE_GET_SYSCALL_INFO, id, sizeof call, &call) <= 0) return KilledAt::untraceable;
        if (call.op != PTRACE_SYSCALL_INFO_ENTRY || !changes_files(call) || --n > 0) continue;
        ::kill(id, SIGKILL);
        process.wait();
        return KilledAt::there;
    }
}

}  // namespace twinchute::test
