// Reads a file with a library that a damaged file may crash: in a child process that sends what it finds through a
// pipe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace host_sim {

/// What a leaf of a file is.
enum class LeafKind : std::uint8_t {
  numbers,  ///< numeric, of any shape, in column order (the first index runs fastest)
  text,     ///< characters
  complex,  ///< complex numbers
  other,    ///< anything else
  damaged,  ///< its length does not fit its data
  last = damaged
};

/// One array, text or attribute of a file.
struct Leaf {
  std::string path;  ///< "a.Y(2).Data" in MATLAB files, "/run/force" in HDF5
  LeafKind kind = LeafKind::other;
  std::vector<std::size_t> shape{};
  std::vector<double> numbers{};
  std::string text{};

  /// A vector: at most one dimension is longer than one, and it is not empty.
  [[nodiscard]] bool is_vector() const;
};

/// The child's end of the pipe.
class LeafSender {
 public:
  explicit LeafSender(int descriptor) : descriptor_(descriptor) {}
  void send(const Leaf& leaf) const;
  /// Tells that everything was sent, with a number for the parent to check.
  void finish(std::size_t count) const;

 private:
  void send_bytes(const void* bytes, std::size_t size) const;

  int descriptor_;
};

/// What a child sent.
struct IsolatedResult {
  std::vector<Leaf> leaves;
  std::size_t count;  ///< of finish()
};

/// Runs `read` on the file `source` in a child process. The child gets 120 s of processor time and the memory that a
/// file of this size can need, at most 4 GiB: a damaged length makes the libraries ask for more, or go round in
/// circles. InputError ("the file is damaged after …", `expected`) when the child ends without finish() or a leaf is
/// damaged.
[[nodiscard]] IsolatedResult read_isolated(const std::string& source, std::string_view expected,
                                           const std::function<void(const LeafSender&)>& read);

}  // namespace host_sim
