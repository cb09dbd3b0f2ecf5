#include "core/shared_object.h"

#include <dlfcn.h>

#include "core/error.h"

namespace lamella {

void* find_function(const std::string& object, const char* function) {
  void* const handle = ::dlopen(object.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* const address = handle == nullptr ? nullptr : ::dlsym(handle, function);
  if (address != nullptr) return address;
  // dlerror() is the calling thread's own.
  const char* const why = ::dlerror();
  throw InputError(std::string("a part of the program can't be loaded: ") + (why == nullptr ? "it is empty" : why),
                   object, "install Lamella again, with its folder of libraries, and the libraries that it names");
}

}  // namespace lamella
