// A function as an argument, called through a pointer: who takes it is compiled once, and not for each function.
#pragma once

#include <memory>
#include <type_traits>
#include <utility>

namespace aos {

template <class Signature>
class FunctionRef;

// Holds nothing: the function has to live as long as it is used.
template <class Result, class... Arguments>
class FunctionRef<Result(Arguments...)> {
 public:
  template <class Function>
    requires(!std::is_same_v<std::remove_cvref_t<Function>, FunctionRef>)
  FunctionRef(Function&& function)
      : function_(const_cast<void*>(static_cast<const void*>(std::addressof(function)))),
        call_([](void* called, Arguments... arguments) -> Result {
          return (*static_cast<std::remove_reference_t<Function>*>(called))(std::forward<Arguments>(arguments)...);
        }) {}

  Result operator()(Arguments... arguments) const { return call_(function_, std::forward<Arguments>(arguments)...); }

 private:
  void* function_;
  Result (*call_)(void* called, Arguments... arguments);
};

}
