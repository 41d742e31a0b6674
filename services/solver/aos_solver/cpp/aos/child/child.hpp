// The engine as a child process. It reads commands as lines of text (command.hpp) and answers each by a line of JSON.
// Lines of progress may come before the answer.
//
// The answers go to a descriptor of their own; what model code prints goes to standard error. Its guard has it die
// with its parent. A fault of model code is an answer. After a crash, the blame page tells which document code ran.
#pragma once

#include <poll.h>

#include "aos/base/progress.hpp"
#include "aos/child/command.hpp"
#include "aos/child/commands.hpp"
#include "aos/child/faults.hpp"
#include "aos/child/reaching.hpp"
#include "aos/child/watchdog.hpp"
#include "aos/model/blame.hpp"
#include "aos/model/mission_parameters.hpp"

namespace aos {

namespace detail {

inline void share_blame(int file) {
  if (file < 0) return;
  auto* const place = const_cast<std::uint32_t*>(blame::page);
  ::mmap(place, blame::page_bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_FIXED, file, 0);
  ::close(file);
}

// Whether a command waits. The loop asks this after an answer, when it has read nothing of the next command.
inline bool has_input() {
  pollfd input{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
  return ::poll(&input, 1, 0) > 0;
}

// Lines of progress come before the answer.
inline std::FILE* told = nullptr;
inline void say_progress(const char* what, std::uint64_t done, std::uint64_t all) {
  std::fprintf(told, "{\"progress\":{\"what\":\"%s\",\"done\":%llu,\"all\":%llu}}\n", what,
               static_cast<unsigned long long>(done), static_cast<unsigned long long>(all));
  std::fflush(told);
}

inline void take_mission_value_of(std::string_view argument) {
  const auto equals = argument.find('=');
  if (equals != std::string_view::npos) mission_values.add(argument.substr(0, equals), argument.substr(equals + 1));
}

inline void say(std::FILE* out, const JsonWriter& json) {
  std::fwrite(json.text().data(), 1, json.text().size(), out);
  std::fputc('\n', out);
  std::fflush(out);
}

}  // namespace detail

// The main function of an engine child. BLAME and BELIEFS are descriptors, negative ones for none; BELIEFS is for
// KeptBeliefs, DRAWS is the seed of the initial belief's draws, and MAX_PERIODS is for the watchdog. The values are those of
// mission parameters, as StateReader reads them.
template <class Model>
int run_child(int argc, char** argv) {
  if (argc < 6) {
    std::fprintf(stderr, "usage: %s BLAME BELIEFS DRAWS hold|widen|reset MAX_PERIODS [NAME=VALUE]...\n", argv[0]);
    return 2;
  }
  for (int place = 6; place < argc; ++place) detail::take_mission_value_of(argv[place]);
  detail::share_blame(std::atoi(argv[1]));
  watchdog::start(std::atoi(argv[5]));
  reaching::start();
  std::FILE* out = ::fdopen(::dup(STDOUT_FILENO), "w");
  detail::told = out;
  ::dup2(STDERR_FILENO, STDOUT_FILENO);

  const std::string_view policy_text = argv[4];
  const auto policy = policy_text == "hold"    ? ImpossiblePolicy::hold
                      : policy_text == "reset" ? ImpossiblePolicy::reset
                                               : ImpossiblePolicy::widen;
  std::unique_ptr<Commands<Model>> commands;
  JsonWriter json;
  guarded(json, [&] {
    Model::prepare();
    commands = std::make_unique<Commands<Model>>(std::strtoull(argv[3], nullptr, 10), policy, std::atoi(argv[2]));
    commands->describe(json);
  });
  detail::say(out, json);

  char* line = nullptr;
  std::size_t capacity = 0;
  for (;;) {
    const ssize_t length = ::getline(&line, &capacity, stdin);
    if (length < 0 || !commands) break;
    std::string_view text{line, static_cast<std::size_t>(length)};
    if (!text.empty() && text.back() == '\n') text.remove_suffix(1);
    json.clear();
    progress::tell_to(detail::say_progress);
    guarded(json, [&] { commands->answer(Command{std::string{text}}, json); });
    progress::tell_to(nullptr);  // nobody reads while nothing is asked
    watchdog::allow(0);
    detail::say(out, json);
    commands->go_on_pondering([] { return detail::has_input(); });
  }
  std::free(line);
  return 0;
}

}  // namespace aos
