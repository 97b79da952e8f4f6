// TDMS files for tests, written after National Instruments' "TDMS File Format Internal Structure".
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace support {

class TdmsBytes {
 public:
  explicit TdmsBytes(bool big_endian) : big_endian_(big_endian) {}

  [[nodiscard]] const std::string& text() const { return text_; }

  /// Group "Run 'A'" with channels Stroke [mm] and Force [kN], double precision, 1 kHz, in segments of chunks.
  void add_run(const std::vector<double>& stroke, const std::vector<double>& force, bool interleaved,
               std::size_t segments, std::size_t chunks) {
    const std::size_t per_segment = stroke.size() / segments;
    const std::size_t per_chunk = per_segment / chunks;
    for (std::size_t s = 0; s < segments; ++s) {
      std::string meta;
      if (s == 0) {
        put32(meta, 4);
        put_object(meta, "/", 0);
        put32(meta, 0);
        put_object(meta, "/'Run ''A'''", 0);
        put32(meta, 0);
        put_channel(meta, "Stroke", "mm", per_chunk);
        put_channel(meta, "Force", "kN", per_chunk);
      }
      std::string raw;
      for (std::size_t c = 0; c < chunks; ++c) {
        const std::size_t first = s * per_segment + c * per_chunk;
        if (interleaved) {
          for (std::size_t k = first; k < first + per_chunk; ++k) {
            put_double(raw, stroke[k]);
            put_double(raw, force[k]);
          }
        } else {
          for (std::size_t k = first; k < first + per_chunk; ++k) put_double(raw, stroke[k]);
          for (std::size_t k = first; k < first + per_chunk; ++k) put_double(raw, force[k]);
        }
      }
      const unsigned contents = (s == 0 ? 6U : 0U) | 8U | (interleaved ? 32U : 0U) | (big_endian_ ? 64U : 0U);
      text_ += "TDSm";
      for (unsigned i = 0; i < 4; ++i) text_ += static_cast<char>(contents >> (8 * i) & 0xffU);
      put32(text_, 4713);
      put64(text_, meta.size() + raw.size());
      put64(text_, meta.size());
      text_ += meta + raw;
    }
  }

 private:
  void put(std::string& bytes, std::uint64_t value, std::size_t size) const {
    for (std::size_t i = 0; i < size; ++i) {
      bytes += static_cast<char>(value >> (8 * (big_endian_ ? size - 1 - i : i)) & 0xffU);
    }
  }
  void put32(std::string& bytes, std::uint64_t value) const { put(bytes, value, 4); }
  void put64(std::string& bytes, std::uint64_t value) const { put(bytes, value, 8); }
  void put_double(std::string& bytes, double value) const { put64(bytes, std::bit_cast<std::uint64_t>(value)); }
  void put_text(std::string& bytes, std::string_view value) const {
    put32(bytes, value.size());
    bytes += value;
  }
  void put_object(std::string& bytes, std::string_view path, std::size_t count) const {
    put_text(bytes, path);
    if (count == 0) return put32(bytes, 0xffffffff);
    put32(bytes, 20);
    put32(bytes, 10);  // double precision
    put32(bytes, 1);
    put64(bytes, count);
  }
  void put_channel(std::string& bytes, const std::string& name, std::string_view unit, std::size_t count) const {
    put_object(bytes, "/'Run ''A'''/'" + name + "'", count);
    put32(bytes, 2);
    put_text(bytes, "unit_string");
    put32(bytes, 0x20);
    put_text(bytes, unit);
    put_text(bytes, "wf_increment");
    put32(bytes, 10);
    put_double(bytes, 1e-3);
  }

  bool big_endian_;
  std::string text_;
};

}  // namespace support
