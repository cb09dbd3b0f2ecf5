#pragma once

#include <filesystem>
#include <hdf5.h>
#include <mutex>
#include <string>
#include <utility>

/// Thin owners around the C interface of HDF5; nothing outside slicing/store sees them.
namespace lamella::hdf5 {

/// Closes an HDF5 identifier when it goes out of scope.
template <herr_t (*Close)(hid_t)>
class Handle {
 public:
  Handle() = default;
  explicit Handle(hid_t id) : id_(id) {}
  ~Handle() { reset(); }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }

  [[nodiscard]] bool is_valid() const { return id_ >= 0; }
  [[nodiscard]] hid_t id() const { return id_; }

  /// Closes now; false when HDF5 could not.
  bool reset() {
    const hid_t id = std::exchange(id_, H5I_INVALID_HID);
    return id < 0 || Close(id) >= 0;
  }

 private:
  hid_t id_ = H5I_INVALID_HID;
};

using File = Handle<H5Fclose>;
using Group = Handle<H5Gclose>;
using Dataset = Handle<H5Dclose>;
using Attribute = Handle<H5Aclose>;
using Space = Handle<H5Sclose>;
using Type = Handle<H5Tclose>;
using Properties = Handle<H5Pclose>;

/// Held while HDF5 is used: serialises access (the library need not be built thread-safe) and keeps it from printing.
/// May be nested within a thread.
class Session {
 public:
  Session();
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

 private:
  std::unique_lock<std::recursive_mutex> lock_;
  H5E_auto2_t print_ = nullptr;
  void* print_data_ = nullptr;
};

/// What HDF5 says about its last failure, in one line.
[[nodiscard]] std::string last_error();

/// Throws ExportError about `path` when `status` is negative, else returns it.
hid_t written(hid_t status, const std::filesystem::path& path);

}  // namespace lamella::hdf5
