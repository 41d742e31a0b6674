// Faults as answers of an engine child. A fault is the documents' if it shows while their code runs, else the engine's.
#pragma once

#include <exception>

#include "aos/base/fault.hpp"
#include "aos/child/command.hpp"
#include "aos/draws/enumerator.hpp"
#include "aos/model/blame.hpp"
#include "aos/text/json.hpp"
#include "point_based/online.hpp"

namespace aos {

// `piece` is the document code that ran, or 0.
struct Fault {
  std::string code;
  std::string text;
  std::uint32_t piece = 0;
};

inline Fault fault_of_code_or_engine(const std::string& text) {
  if (blame::piece() != 0) return {"AOS215", text, blame::piece()};
  return {"AOS217", "the engine failed outside of the documents' code: " + text};
}

// The fault that the exception in hand stands for. It is called while that is handled.
inline Fault current_fault() {
  try {
    throw;
  } catch (const ModelFault& fault) {
    return {fault.code, fault.text, blame::piece()};
  } catch (const NotEnumerable& limit) {
    return {"AOS220", limit.reason};
  } catch (const BadCommand& bad) {
    return {"AOS217", bad.text};
  } catch (const point_based::CrossedBounds& crossed) {
    return {"AOS216", crossed.what()};
  } catch (const std::bad_alloc& error) {
    if (blame::piece() != 0) return fault_of_code_or_engine(error.what());
    return {"AOS213", "the engine has no memory left; a smaller budget or a shorter horizon needs less"};
  } catch (const std::exception& error) {
    return fault_of_code_or_engine(error.what());
  } catch (...) {
    return fault_of_code_or_engine("something was thrown that is no std::exception");
  }
}

inline void write_members(JsonWriter& json, const Fault& fault) {
  json.member("code", fault.code).member("text", fault.text).member("piece", fault.piece);
}

// Runs `work`. A fault becomes the answer.
void guarded(JsonWriter& json, auto&& work) {
  try {
    work();
  } catch (...) {
    const Fault fault = current_fault();
    json.clear();
    json.begin_object().key("fault").begin_object();
    write_members(json, fault);
    json.end_object().end_object();
  }
  blame::at(0);
}

}
