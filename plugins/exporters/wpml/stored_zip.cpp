// SPDX-License-Identifier: Apache-2.0
#include "plugins/exporters/wpml/stored_zip.h"

#include <array>
#include <cstdint>

#include "framework/core/error.h"

namespace lapwing::wpml_file {
namespace {

constexpr std::uint32_t kLocal = 0x04034b50, kEntry = 0x02014b50, kEnd = 0x06054b50;
constexpr std::uint32_t kFirstDay = 0x0021;  // 1 January 1980

void put(std::string& out, std::uint32_t number, int bytes) {
  for (int i = 0; i < bytes; ++i) out += static_cast<char>((number >> (8 * i)) & 0xff);
}

std::uint32_t word(const std::string& bytes, std::size_t at, int count) {
  if (at + static_cast<std::size_t>(count) > bytes.size()) throw InputError("zip: cut short");
  std::uint32_t number = 0;
  for (int i = 0; i < count; ++i)
    number |= static_cast<std::uint32_t>(
                  static_cast<unsigned char>(bytes[at + static_cast<std::size_t>(i)]))
              << (8 * i);
  return number;
}

std::uint32_t checksum(const std::string& bytes) {
  std::uint32_t crc = 0xffffffff;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int i = 0; i < 8; ++i) crc = (crc >> 1) ^ ((crc & 1) ? 0xedb88320u : 0u);
  }
  return ~crc;
}

// What a local header and an entry of the directory share: version, flags (names are UTF-8),
// method, time, checksum, sizes, length of the name.
void put_common(std::string& out, const std::string& name, const std::string& content) {
  put(out, 20, 2);
  put(out, 0x0800, 2);
  put(out, 0, 2);
  put(out, 0, 2);
  put(out, kFirstDay, 2);
  put(out, checksum(content), 4);
  put(out, static_cast<std::uint32_t>(content.size()), 4);
  put(out, static_cast<std::uint32_t>(content.size()), 4);
  put(out, static_cast<std::uint32_t>(name.size()), 2);
  put(out, 0, 2);
}

}  // namespace

std::string zip_bytes(const NamedContents& files) {
  std::string out, directory;
  for (const auto& [name, content] : files) {
    const auto place = static_cast<std::uint32_t>(out.size());
    put(out, kLocal, 4);
    put_common(out, name, content);
    out += name + content;
    put(directory, kEntry, 4);
    put(directory, 20, 2);
    put_common(directory, name, content);
    put(directory, 0, 2);  // comment
    put(directory, 0, 2);  // disk
    put(directory, 0, 2);  // attributes
    put(directory, 0, 4);
    put(directory, place, 4);
    directory += name;
  }
  const auto begin = static_cast<std::uint32_t>(out.size());
  out += directory;
  put(out, kEnd, 4);
  put(out, 0, 4);
  put(out, static_cast<std::uint32_t>(files.size()), 2);
  put(out, static_cast<std::uint32_t>(files.size()), 2);
  put(out, static_cast<std::uint32_t>(directory.size()), 4);
  put(out, begin, 4);
  put(out, 0, 2);
  return out;
}

std::string file_in_zip(const std::string& zip, const std::string& name) {
  for (std::size_t at = 0; at + 30 <= zip.size() && word(zip, at, 4) == kLocal;) {
    const std::size_t size = word(zip, at + 18, 4), length = word(zip, at + 26, 2);
    const std::size_t content = at + 30 + length + word(zip, at + 28, 2);
    if (content + size > zip.size()) break;
    if (zip.compare(at + 30, length, name) == 0) return zip.substr(content, size);
    at = content + size;
  }
  throw InputError("zip: no file '" + name + "'");
}

}  // namespace lapwing::wpml_file
