// Memory that lies in files, so that a recording may be larger than the memory of the machine.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace host_sim {

/// Where the memory of a large recording lies:
///
///   input file ── mapped, read only ─┐
///                                    ├─ pages that are in use ≤ 160 MiB, the others are on the disk or in its cache
///   columns ──── temporary file ─────┘
///
/// A thread looks every 5 ms at the memory that the process holds. Beyond `most_resident` it gives back all pages of
/// the mappings: what is needed again comes from the file. Half of the limit halves the memory and doubles the page
/// faults, which take 2 % of the time of an import; twice of it saves 1 %.
inline constexpr std::size_t most_resident = std::size_t{160} << 20U;  // [byte]

/// From here on blocks of a megabyte and more come from temporary files ($TMPDIR, else /var/tmp) where more than
/// `most_on_heap` of such blocks are in use: for commands that hold whole recordings. In a program without
/// host_sim/large_blocks.cpp, or where no disk is at hand, they stay on the heap.
void keep_large_blocks_in_files();
inline constexpr std::size_t most_on_heap = std::size_t{32} << 20U;      // [byte] of all large blocks
inline constexpr std::size_t least_large_block = std::size_t{1} << 20U;  // [byte]

/// Whether keep_large_blocks_in_files() was called.
[[nodiscard]] bool large_blocks_are_in_files() noexcept;

/// A block in a temporary file of its own, which has no name; nullptr: there is none (no disk, or no room on it).
[[nodiscard]] void* take_file_block(std::size_t size) noexcept;

/// Whether the block is one of take_file_block(), and then releases it.
bool release_file_block(void* block) noexcept;

/// The contents of an open file: mapped where it is a large regular file, else read.
class FileContents {
 public:
  /// `head`: bytes that have been read from the descriptor already. InputError if it cannot be read, and for a stream
  /// of more than 2 GiB, which may be endless.
  FileContents(int descriptor, std::string_view head, std::string_view source);
  ~FileContents();
  FileContents(const FileContents&) = delete;
  FileContents& operator=(const FileContents&) = delete;

  [[nodiscard]] std::string_view bytes() const {
    return mapping_ == nullptr ? std::string_view(read_) : std::string_view(static_cast<const char*>(mapping_), size_);
  }

 private:
  std::string read_;
  void* mapping_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace host_sim
