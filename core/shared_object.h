#pragma once

#include <string>

namespace lamella {

/// The address of a function with C linkage in a shared object, which is loaded at the first call for it and stays.
/// `object` is a file name without a folder, found by the run paths of the program, never in the working directory.
/// Safe from several threads. Throws InputError when the object, or the function in it, isn't there.
[[nodiscard]] void* find_function(const std::string& object, const char* function);

/// The same as a function of a stated type, which nothing checks.
template <class Function>
[[nodiscard]] Function* find_function_of(const std::string& object, const char* function) {
  // POSIX asks of dlsym() that this cast works.
  return reinterpret_cast<Function*>(find_function(object, function));
}

}  // namespace lamella
