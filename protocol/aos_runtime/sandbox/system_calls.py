"""The system calls that filters name: their numbers, and which of them belong together.

Numbers are those of asm/unistd_64.h (x86-64) and asm-generic/unistd.h (arm64). From 424 on all architectures
have the same.
"""

ARCHITECTURES = {"x86_64": 0xC000003E, "aarch64": 0xC00000B7}
"""The machines, as `uname` names them, that filters can be made for, and what the kernel calls them."""

NEWEST_KNOWN = 434
"""Programs that try a newer call do without it where the kernel does not have it."""

_NUMBERS = """
accept 43 202; accept4 288 242; access 21 -; acct 163 89; add_key 248 217; adjtimex 159 171;
arch_prctl 158 -; bind 49 200; bpf 321 280; brk 12 214; chmod 90 -; chown 92 -; chroot 161 51;
clock_getres 229 114; clock_gettime 228 113; clock_nanosleep 230 115; clock_settime 227 112; clone 56 220;
clone3 435 435; close 3 57; close_range 436 436; connect 42 203; creat 85 -; delete_module 176 106;
dup 32 23; dup2 33 -; dup3 292 24; epoll_pwait2 441 441; execve 59 221; execveat 322 281; exit 60 93;
exit_group 231 94; faccessat 269 48; faccessat2 439 439; fadvise64 221 223; fanotify_init 300 262;
fchmod 91 52; fchmodat 268 53; fchown 93 55; fchownat 260 54; fcntl 72 25; finit_module 313 273; fork 57 -;
fsconfig 431 431; fsetxattr 190 7; fsmount 432 432; fsopen 430 430; fspick 433 433; fstat 5 80;
fstatfs 138 44; futex 202 98; futex_waitv 449 449; futimesat 261 -; get_robust_list 274 100; getcpu 309 168;
getcwd 79 17; getdents 78 -; getdents64 217 61; getegid 108 177; geteuid 107 175; getgid 104 176;
getitimer 36 102; getpeername 52 205; getpgid 121 155; getpgrp 111 -; getpid 39 172; getppid 110 173;
getrandom 318 278; getresgid 120 150; getresuid 118 148; getrlimit 97 163; getrusage 98 165; getsid 124 156;
getsockname 51 204; gettid 186 178; gettimeofday 96 169; getuid 102 174; init_module 175 105;
io_uring_enter 426 426; io_uring_register 427 427; io_uring_setup 425 425; ioctl 16 29; ioperm 173 -;
iopl 172 -; kcmp 312 272; kexec_file_load 320 294; kexec_load 246 104; keyctl 250 219; kill 62 129;
lchown 94 -; link 86 -; linkat 265 37; listen 50 201; lookup_dcookie 212 18; lseek 8 62; lsetxattr 189 6;
lstat 6 -; madvise 28 233; membarrier 324 283; memfd_create 319 279; mincore 27 232; mkdir 83 -;
mkdirat 258 34; mknod 133 -; mknodat 259 33; mmap 9 222; mount 165 40; move_mount 429 429; mprotect 10 226;
mremap 25 216; msgctl 71 187; msgget 68 186; msgrcv 70 188; msgsnd 69 189; munmap 11 215;
name_to_handle_at 303 264; nanosleep 35 101; newfstatat 262 79; open 2 -; open_by_handle_at 304 265;
open_tree 428 428; openat 257 56; openat2 437 437; perf_event_open 298 241; pidfd_getfd 438 438;
pidfd_open 434 434; pidfd_send_signal 424 424; pipe 22 -; pipe2 293 59; pivot_root 155 41; poll 7 -;
ppoll 271 73; pread64 17 67; preadv 295 69; prlimit64 302 261; process_madvise 440 440;
process_vm_readv 310 270; process_vm_writev 311 271; pselect6 270 72; ptrace 101 117; pwrite64 18 68;
pwritev 296 70; quotactl 179 60; read 0 63; readlink 89 -; readlinkat 267 78; readv 19 65; reboot 169 142;
recvfrom 45 207; recvmmsg 299 243; recvmsg 47 212; rename 82 -; renameat 264 38; renameat2 316 276;
request_key 249 218; restart_syscall 219 128; rmdir 84 -; rseq 334 293; rt_sigaction 13 134;
rt_sigpending 127 136; rt_sigprocmask 14 135; rt_sigqueueinfo 129 138; rt_sigreturn 15 139;
rt_sigsuspend 130 133; rt_sigtimedwait 128 137; rt_tgsigqueueinfo 297 240; sched_get_priority_max 146 125;
sched_get_priority_min 147 126; sched_getaffinity 204 123; sched_getparam 143 121;
sched_getscheduler 145 120; sched_yield 24 124; seccomp 317 277; select 23 -; semctl 66 191; semget 64 190;
semop 65 193; semtimedop 220 192; sendmmsg 307 269; sendmsg 46 211; sendto 44 206; set_robust_list 273 99;
set_tid_address 218 96; setdomainname 171 162; sethostname 170 161; setitimer 38 103; setns 308 268;
setpgid 109 154; setpriority 141 140; setsid 112 157; setxattr 188 5; shmat 30 196; shmctl 31 195;
shmdt 67 197; shmget 29 194; shutdown 48 210; sigaltstack 131 132; socket 41 198; socketpair 53 199;
stat 4 -; statfs 137 43; statx 332 291; swapoff 168 225; swapon 167 224; symlink 88 -; symlinkat 266 36;
sync_file_range 277 84; sysinfo 99 179; syslog 103 116; tgkill 234 131; time 201 -; times 100 153;
tkill 200 130; truncate 76 45; umount2 166 39; uname 63 160; unlink 87 -; unlinkat 263 35; unshare 272 97;
userfaultfd 323 282; utime 132 -; utimensat 280 88; utimes 235 -; vfork 58 -; vhangup 153 58; write 1 64;
writev 20 66
"""


def _names(text: str) -> tuple[str, ...]:
    return tuple(text.split())


ALLOWED = _names("""
    read write readv writev pread64 pwrite64 preadv pwritev lseek close close_range dup dup2 dup3
    pipe pipe2 fstat stat lstat newfstatat statx statfs fstatfs access faccessat faccessat2 readlink
    readlinkat getcwd getdents getdents64 fadvise64 sync_file_range poll ppoll select pselect6 mmap
    munmap mremap mprotect madvise mincore brk membarrier arch_prctl futex futex_waitv
    set_robust_list get_robust_list set_tid_address rseq getcpu sched_yield sched_getaffinity
    sched_getparam sched_getscheduler sched_get_priority_max sched_get_priority_min clock_gettime
    clock_getres clock_nanosleep nanosleep gettimeofday time times setitimer getitimer getpid gettid
    getppid getpgrp getpgid getsid getuid geteuid getgid getegid getresuid getresgid getrusage
    getrlimit getrandom sysinfo uname rt_sigaction rt_sigprocmask rt_sigreturn rt_sigpending
    rt_sigsuspend rt_sigtimedwait sigaltstack restart_syscall exit exit_group
""")
"""All that computing takes, with threads, with files that are read, and with descriptors that were given."""

NETWORK = _names("""
    socket socketpair bind connect listen accept accept4 sendto recvfrom sendmsg recvmsg sendmmsg
    recvmmsg shutdown getsockname getpeername
""")

OTHER_PROCESSES = _names("""
    ptrace process_vm_readv process_vm_writev process_madvise kcmp pidfd_open pidfd_send_signal
    pidfd_getfd kill tkill tgkill rt_sigqueueinfo rt_tgsigqueueinfo setpriority perf_event_open
    shmget shmat shmctl shmdt semget semop semtimedop semctl msgget msgsnd msgrcv msgctl
""")
"""Signals, and looking into others and sharing memory with them."""

CHANGES_OF_OWNERS = _names("""
    chmod fchmod fchmodat chown fchown lchown fchownat utime utimes futimesat utimensat setxattr
    lsetxattr fsetxattr
""")
"""Landlock leaves these open for every file of the user."""

CHANGES_OF_FILES = _names("""
    truncate creat mkdir mkdirat mknod mknodat rmdir unlink unlinkat rename renameat renameat2 link
    linkat symlink symlinkat memfd_create
""")

NEW_PROCESSES = _names("""
    fork vfork execveat setsid setpgid
""")

SYSTEM = _names("""
    bpf userfaultfd io_uring_setup io_uring_enter io_uring_register add_key request_key keyctl mount
    umount2 pivot_root chroot unshare setns open_tree move_mount fsopen fsconfig fsmount fspick
    name_to_handle_at open_by_handle_at fanotify_init quotactl acct init_module finit_module
    delete_module kexec_load kexec_file_load reboot swapon swapoff syslog sethostname setdomainname
    clock_settime adjtimex iopl ioperm lookup_dcookie vhangup
""")
"""Calls for administrators, and those that no filter can look into."""


def numbers_of(machine: str) -> dict[str, int]:
    """The number of each call that a machine has."""
    column = list(ARCHITECTURES).index(machine) + 1
    entries = (entry.split() for entry in _NUMBERS.split(";"))
    return {entry[0]: int(entry[column]) for entry in entries if entry[column] != "-"}
