#include "slicing/store/hdf5.h"

#include "core/error.h"

namespace lamella::hdf5 {

namespace {

std::recursive_mutex& library_mutex() {
  static std::recursive_mutex mutex;
  return mutex;
}

/// Keeps the innermost description, which names the cause.
herr_t keep_first(unsigned depth, const H5E_error2_t* error, void* text) {
  if (depth == 0 && error->desc != nullptr) *static_cast<std::string*>(text) = error->desc;
  return 0;
}

}  // namespace

Session::Session() : lock_(library_mutex()) {
  H5Eget_auto2(H5E_DEFAULT, &print_, &print_data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  // A file may name filters to be loaded as plugins from disk; ours needs none.
  H5PLset_loading_state(0);
}

Session::~Session() { H5Eset_auto2(H5E_DEFAULT, print_, print_data_); }

std::string last_error() {
  std::string text;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_first, &text);
  return text.empty() ? "HDF5 failed" : "HDF5: " + text;
}

hid_t written(hid_t status, const std::filesystem::path& path) {
  if (status < 0) throw ExportError("can't write slices: " + last_error(), path.string());
  return status;
}

}  // namespace lamella::hdf5
