// An opened recording file and its format, for the readers.
#pragma once

#include <filesystem>
#include <string>

namespace firmware {

/// Opens a file and reads its first kilobyte. InputError if it cannot be opened or read or is a directory.
class RecordingFile {
 public:
  explicit RecordingFile(const std::filesystem::path& file);
  ~RecordingFile();
  RecordingFile(const RecordingFile&) = delete;
  RecordingFile& operator=(const RecordingFile&) = delete;

  [[nodiscard]] int descriptor() const { return descriptor_; }
  [[nodiscard]] const std::string& head() const { return head_; }
  [[nodiscard]] bool is_matlab() const;  ///< version 5 or 7.3

 private:
  int descriptor_;
  std::string head_;
};

}  // namespace firmware
