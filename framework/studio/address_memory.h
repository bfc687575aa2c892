// SPDX-License-Identifier: Apache-2.0
// Where a studio that was killed could be reached, so that its pages find the next one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace lapwing {

struct StudioPlace {
  std::uint16_t port = 0;
  std::string token;
};

// Kept in the user's runtime folder (XDG_RUNTIME_DIR), which others cannot read, as long as a
// studio of this script runs; where there is no such folder nothing is kept. A studio that ends in
// order takes it away; one that was killed leaves it.
class AddressMemory {
 public:
  explicit AddressMemory(const std::filesystem::path& script);
  ~AddressMemory();
  AddressMemory(const AddressMemory&) = delete;
  AddressMemory& operator=(const AddressMemory&) = delete;

  // None where nothing is kept, where others could have written it, or where it is no place.
  std::optional<StudioPlace> find() const;
  void keep(const StudioPlace& place) const;

 private:
  std::filesystem::path file_;  // empty: none
};

}  // namespace lapwing
