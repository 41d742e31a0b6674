// The engine as a child process: a line of tab-separated text in, a line of JSON out.
//
// Answers go to a descriptor of their own; what model code prints goes to standard error. The process dies with its
// parent. A fault of model code is an answer; a crash is told by the blame page.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "aos/base/fault.hpp"
#include "aos/base/observed_numbers.hpp"
#include "aos/child/bad_command.hpp"
#include "aos/child/commands.hpp"
#include "aos/child/watchdog.hpp"
#include "aos/model/blame.hpp"
#include "aos/planning/budget.hpp"

namespace aos {

namespace detail {

inline std::vector<std::string_view> fields_of(std::string_view line, char separator = '\t') {
  std::vector<std::string_view> fields;
  for (;;) {
    const auto end = line.find(separator);
    fields.push_back(line.substr(0, end));
    if (end == std::string_view::npos) return fields;
    line.remove_prefix(end + 1);
  }
}

template <class Number>
Number number_of(const std::vector<std::string_view>& fields, std::size_t index) {
  Number number{};
  if (index >= fields.size()) throw BadCommand{"a field is missing"};
  const std::string_view text = fields[index];
  const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
  if (read.ec != std::errc{} || read.ptr != text.data() + text.size()) {
    throw BadCommand{"not a number: " + std::string{text}};
  }
  return number;
}

template <class Number>
std::vector<Number> numbers_from(const std::vector<std::string_view>& fields, std::size_t first) {
  std::vector<Number> numbers;
  for (std::size_t index = first; index < fields.size(); ++index) numbers.push_back(number_of<Number>(fields, index));
  return numbers;
}

// Each as its name's number, its index and its value, all apart by spaces.
inline ObservedNumbers observed_numbers_of(std::string_view text) {
  const auto parts = text.empty() ? std::vector<std::string_view>{} : fields_of(text, ' ');
  ObservedNumbers numbers;
  for (std::size_t part = 0; part < parts.size(); part += 3) {
    const auto key = number_key(number_of<std::uint32_t>(parts, part), number_of<std::uint32_t>(parts, part + 1));
    if (!numbers.add(key, number_of<double>(parts, part + 2))) throw BadCommand{"a number is given twice"};
  }
  return numbers;
}

inline PlannerKind planner_of(const std::vector<std::string_view>& fields, std::size_t index) {
  const auto kind = planner_kind(fields.at(index));
  if (!kind) throw BadCommand{"there is no planner " + std::string{fields[index]}};
  return *kind;
}

// Simulations, seconds and, at another place, threads.
inline Budget budget_of(const std::vector<std::string_view>& fields, std::size_t index, std::size_t threads_index) {
  const int threads = number_of<int>(fields, threads_index);
  return {number_of<std::uint64_t>(fields, index), number_of<double>(fields, index + 1),
          std::clamp(threads, 1, most_search_threads)};
}

template <class Model>
void answer(Engine<Model>& engine, const std::vector<std::string_view>& fields, JsonWriter& json) {
  const std::string_view command = fields[0];
  const auto whole = [&](std::size_t index) { return number_of<int>(fields, index); };
  const auto large = [&](std::size_t index) { return number_of<std::uint64_t>(fields, index); };
  const auto real = [&](std::size_t index) { return number_of<double>(fields, index); };
  if (command == "describe") return engine.describe(json);
  if (command == "reset_belief") return engine.reset_belief(json);
  if (command == "draw_belief") return engine.draw_belief(json);
  if (command == "summary") return engine.summary(json);
  if (command == "plan") {
    return engine.plan(json, budget_of(fields, 1, 6), large(3), whole(4), planner_of(fields, 5),
                       numbers_from<int>(fields, 7));
  }
  if (command == "think") return engine.think(json, budget_of(fields, 1, 5), large(3), whole(4));
  if (command == "count_processor_time") return engine.count_processor_time(json, whole(1) != 0);
  if (command == "exact") return engine.exact(json, whole(1), large(2), real(3));
  if (command == "reach") return engine.reach(json, real(1));
  if (command == "list") return engine.list(json, large(1));
  if (command == "write_listing") {
    return engine.write_listing(json, std::string{fields.at(1)}, std::string{fields.at(2)});
  }
  if (command == "predict") return engine.predict(json, whole(1));
  if (command == "update") {
    const bool has_locals = fields.size() > 4;
    const auto locals = has_locals ? std::optional{fields[4]} : std::nullopt;
    return engine.update(json, whole(1), fields.at(2), observed_numbers_of(fields.at(3)), locals);
  }
  if (command == "update_without_observation") return engine.update_without_observation(json, whole(1), real(2));
  if (command == "export_belief") return engine.export_belief(json, large(1), whole(2) != 0);
  if (command == "import_belief") {
    return engine.import_belief(json, real(1), whole(2) != 0, fields.at(3), large(4), {fields.begin() + 5, fields.end()});
  }
  if (command == "restore_belief") return engine.restore_belief(json, large(1));
  if (command == "reset_world") return engine.reset_world(json, large(1));
  if (command == "step_world") return engine.step_world(json, whole(1));
  if (command == "show_world") return engine.show_world(json);
  if (command == "reset_worlds") return engine.reset_worlds(json, numbers_from<std::uint64_t>(fields, 1));
  if (command == "step_worlds") return engine.step_worlds(json, fields.at(1));
  if (command == "rate") return engine.rate(json, real(1), large(2));
  if (command == "rate_by_table") return engine.rate_by_table(json, real(1), large(2));
  throw BadCommand{"unknown command: " + std::string{command}};
}

inline void write_fault(JsonWriter& json, std::string_view code, std::string_view text) {
  json.clear();
  json.begin_object().key("fault").begin_object().member("code", code).member("text", text);
  json.member("piece", blame::piece()).end_object().end_object();
}

// Runs `work`; a fault becomes the answer.
template <class Work>
void guarded(JsonWriter& json, Work&& work) {
  try {
    work();
  } catch (const ModelFault& fault) {
    write_fault(json, fault.code, fault.text);
  } catch (const NotEnumerable& limit) {
    blame::at(0);
    write_fault(json, "AOS220", limit.reason);
  } catch (const BadCommand& bad) {
    blame::at(0);
    write_fault(json, "AOS213", bad.text);
  } catch (const point_based::CrossedBounds& crossed) {
    blame::at(0);
    write_fault(json, "AOS216", crossed.what());
  } catch (const std::exception& error) {
    write_fault(json, "AOS215", error.what());
  } catch (...) {
    write_fault(json, "AOS215", "model code threw something");
  }
  blame::at(0);
}

inline void share_blame(const char* path) {
  const int file = ::open(path, O_RDWR);
  if (file < 0) return;
  auto* const place = const_cast<std::uint32_t*>(blame::page);
  ::mmap(place, blame::page_bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_FIXED, file, 0);
  ::close(file);
}

// Whether a command waits. It is asked after an answer, when nothing of the next command was read yet.
inline bool has_input() {
  pollfd input{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
  return ::poll(&input, 1, 0) > 0;
}

inline void say(std::FILE* out, const JsonWriter& json) {
  std::fwrite(json.text().data(), 1, json.text().size(), out);
  std::fputc('\n', out);
  std::fflush(out);
}

}  // namespace detail

// Arguments: the paths of the blame page and of the kept beliefs, the seed, the policy for impossible observations.
template <class Model>
int run_child(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: %s BLAME_FILE BELIEF_FILE SEED hold|widen|reset\n", argv[0]);
    return 2;
  }
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  detail::share_blame(argv[1]);
  watchdog::start();
  std::FILE* out = ::fdopen(::dup(STDOUT_FILENO), "w");
  ::dup2(STDERR_FILENO, STDOUT_FILENO);

  const std::string_view policy_text = argv[4];
  const auto policy = policy_text == "hold"    ? ImpossiblePolicy::hold
                      : policy_text == "reset" ? ImpossiblePolicy::reset
                                               : ImpossiblePolicy::widen;
  std::unique_ptr<Engine<Model>> engine;
  JsonWriter json;
  detail::guarded(json, [&] {
    Model::prepare();
    engine = std::make_unique<Engine<Model>>(std::strtoull(argv[3], nullptr, 10), policy, argv[2]);
    engine->describe(json);
  });
  detail::say(out, json);

  char* line = nullptr;
  std::size_t capacity = 0;
  for (;;) {
    const ssize_t length = ::getline(&line, &capacity, stdin);
    if (length < 0 || !engine) break;
    std::string_view text{line, static_cast<std::size_t>(length)};
    if (!text.empty() && text.back() == '\n') text.remove_suffix(1);
    json.clear();
    detail::guarded(json, [&] { detail::answer(*engine, detail::fields_of(text), json); });
    detail::say(out, json);
    engine->go_on_thinking(detail::has_input);
  }
  std::free(line);
  return 0;
}

}  // namespace aos
