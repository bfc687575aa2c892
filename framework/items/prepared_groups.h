// SPDX-License-Identifier: Apache-2.0
// What items of one group share, in one process: prepared once, kept while it is in use.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

namespace lapwing {

// Thread-safe. One group is prepared at a time. Besides the groups in use, the last one is kept.
class PreparedGroups {
 public:
  using Prepare = std::function<std::shared_ptr<const void>(std::size_t group)>;
  explicit PreparedGroups(Prepare prepare) : prepare_(std::move(prepare)) {}

  // The group is in use as long as the pointer lives. Adds to `seconds` the time that the
  // preparation took; waiting for that of another thread adds nothing. Throws as the preparation
  // does, which is then repeated for whoever asks next.
  std::shared_ptr<const void> use(std::size_t group, double& seconds);

  std::vector<std::size_t> held() const;

 private:
  const Prepare prepare_;
  std::mutex preparing_;
  mutable std::mutex mutex_;  // of the map
  std::map<std::size_t, std::weak_ptr<const void>> in_use_;
  std::shared_ptr<const void> last_;
};

}  // namespace lapwing
