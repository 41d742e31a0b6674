// Tells which document code reaches for a file or for anything else that a model may not have.
//
// The sandbox around this process refuses it; see docs/security.md. Here a refusal becomes the end of the process, so
// that the blame page has the code that asked. A refused file alone would look like one that is not there. Nothing else
// depends on this: code that takes it away is refused all the same, and not told.
#pragma once

#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <signal.h>
#include <sys/syscall.h>
#include <ucontext.h>
#include <unistd.h>

#include <cerrno>
#include <string_view>

#include "aos/model/blame.hpp"

namespace aos::reaching {

inline constexpr int exit_status = 72;  // known to engine_child.py

namespace detail {

// The sixth argument of calls that the handler repeats. `openat` has four.
inline constexpr std::uint32_t repeated = 0x616f7321;

// What the C library looks at by itself, and does without.
inline bool is_of_the_library(std::string_view path) {
  for (const std::string_view known : {"/proc/sys/vm/overcommit_memory", "/proc/self/maps", "/proc/meminfo", "/proc/stat",
                                       "/proc/cpuinfo", "/dev/tty"}) {
    if (path == known) return true;
  }
  return false;
}

struct Call {
  long number;
  long arguments[4];
};

#if defined(__x86_64__)
inline Call call_of(const siginfo_t& info, const ucontext_t& context) {
  const auto& registers = context.uc_mcontext.gregs;
  return {info.si_syscall, {registers[REG_RDI], registers[REG_RSI], registers[REG_RDX], registers[REG_R10]}};
}
inline void give(ucontext_t& context, long result) { context.uc_mcontext.gregs[REG_RAX] = result; }
#elif defined(__aarch64__)
inline Call call_of(const siginfo_t& info, const ucontext_t& context) {
  const auto& registers = context.uc_mcontext.regs;
  return {info.si_syscall,
          {static_cast<long>(registers[0]), static_cast<long>(registers[1]), static_cast<long>(registers[2]),
           static_cast<long>(registers[3])}};
}
inline void give(ucontext_t& context, long result) {
  context.uc_mcontext.regs[0] = static_cast<unsigned long long>(result);
}
#endif

#if defined(__x86_64__) || defined(__aarch64__)
// The signal handler of a call that a filter has stopped.
inline void decide(int, siginfo_t* info, void* interrupted) {
  const int kept_errno = errno;
  auto& context = *static_cast<ucontext_t*>(interrupted);
  Call call = call_of(*info, context);
#ifdef __NR_open
  if (call.number == __NR_open) call = {__NR_openat, {-100, call.arguments[0], call.arguments[1], call.arguments[2]}};
#endif
  if (call.number != __NR_openat) ::_exit(exit_status);
  const auto [directory, path, flags, mode] = call.arguments;
  const long opened = ::syscall(__NR_openat, directory, path, flags, mode, 0L, static_cast<long>(repeated));
  const long result = opened < 0 ? -errno : opened;
  if (result == -EACCES && blame::piece() != 0 && !is_of_the_library(reinterpret_cast<const char*>(path))) {
    ::_exit(exit_status);
  }
  give(context, result);
  errno = kept_errno;
}
#endif

}  // namespace detail

// From now on, calls that open files come to `decide` first, and calls that the sandbox refuses come to it as well.
inline void start() {
#if defined(__x86_64__) || defined(__aarch64__)
  struct sigaction action{};
  action.sa_sigaction = detail::decide;
  action.sa_flags = SA_SIGINFO;
  ::sigaction(SIGSYS, &action, nullptr);
  constexpr auto sixth = static_cast<std::uint32_t>(offsetof(seccomp_data, args) + 5 * sizeof(std::uint64_t));
  sock_filter steps[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
#ifdef __NR_open
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, __NR_open, 3, 0),
#endif
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, __NR_openat, 0, 3),
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, sixth),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, detail::repeated, 1, 0),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
  };
  const sock_fprog program{static_cast<unsigned short>(sizeof steps / sizeof *steps), steps};
  ::syscall(__NR_seccomp, SECCOMP_SET_MODE_FILTER, 0L, &program);
#endif
}

}  // namespace aos::reaching
