// A recording's file, opened, and what its first bytes say it is. For the readers.
#pragma once

#include <filesystem>
#include <string>

namespace host_sim {

/// Opened for reading, its first kilobyte taken. InputError for what cannot be opened or read, and for a directory.
class RecordingFile {
 public:
  explicit RecordingFile(const std::filesystem::path& file);
  ~RecordingFile();
  RecordingFile(const RecordingFile&) = delete;
  RecordingFile& operator=(const RecordingFile&) = delete;

  [[nodiscard]] int descriptor() const { return descriptor_; }
  [[nodiscard]] const std::string& head() const { return head_; }
  [[nodiscard]] bool is_matlab() const;  ///< 5 or 7.3

 private:
  int descriptor_;
  std::string head_;
};

}  // namespace host_sim
