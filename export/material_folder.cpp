#include "export/material_folder.h"

#include <algorithm>
#include <system_error>

#include "core/atomic_file.h"
#include "core/error.h"

namespace lamella {

namespace fs = std::filesystem;

MaterialFolder::~MaterialFolder() {
  std::error_code ignored;
  if (made_root_) fs::remove(root_, ignored);  // which a folder with files withstands
}

void MaterialFolder::abandon() noexcept {
  std::error_code ignored;
  for (const fs::path& file : files_) fs::remove(file, ignored);
  files_.clear();
}

void MaterialFolder::open(const std::vector<std::string>& names) {
  made_root_ = !fs::exists(fs::symlink_status(root_));
  make_folder(root_);
  std::error_code failure;
  for (fs::directory_iterator entry(root_, failure); !failure && entry != fs::directory_iterator();
       entry.increment(failure)) {
    const std::string name = entry->path().filename().string();
    const bool is_ours = std::any_of(names.begin(), names.end(), [&](const std::string& ours) {
      return name == ours || name.starts_with(ours + ".part-");
    });
    if (is_ours && fs::is_regular_file(entry->symlink_status(failure))) continue;
    throw ExportError("the output folder holds files that this build doesn't write", entry->path().string(),
                      "choose a new or empty folder");
  }
  if (failure) throw ExportError("can't use the output folder: " + failure.message(), root_.string());
}

}  // namespace lamella
