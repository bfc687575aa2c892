// SPDX-License-Identifier: Apache-2.0
// Answers what pages ask about scans that were planned: a voxel, a slice of the map, places that
// were left out, a view; and about the maps of explorations, also of one that is being planned. On
// a thread of its own, so that no plan is waited for. Internal to this room.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "framework/explore/episode_replay.h"
#include "framework/mission/scan_look.h"
#include "framework/studio/frames.h"

namespace lapwing {

class WorkerLooks {
 public:
  // `send` is called on the own thread, with a frame and its serial.
  using Send = std::function<void(Frame answer, std::int64_t serial)>;
  WorkerLooks(Send send, int threads);
  ~WorkerLooks();
  WorkerLooks(const WorkerLooks&) = delete;

  // Whether a frame that asks for this is to be given to `ask`.
  static bool answers(const std::string& what);
  // The tours of the plan whose files lie in this folder, from now on. The last few plans are kept;
  // beside a large one none.
  void keep(const std::string& folder, std::vector<KeptTour> tours);
  // An exploration that is being planned, from now on; then that its plan's files lie in a folder.
  void begin_episode(std::shared_ptr<EpisodeReplay> episode);
  void keep_episode(const std::string& folder);
  void ask(Frame question);

 private:
  struct Kept {
    std::string folder;
    std::vector<KeptTour> tours;             // of a scan
    std::shared_ptr<EpisodeReplay> episode;  // of an exploration
  };

  void work();
  Frame answer(const Frame& question);
  Kept kept_in(const std::string& folder) const;
  void add(Kept one);

  Send send_;
  int threads_;
  mutable std::mutex mutex_;  // of what follows
  std::condition_variable changed_;
  std::deque<Frame> waiting_;
  std::deque<Kept> kept_;                // the newest last
  std::shared_ptr<EpisodeReplay> live_;  // that was begun last
  bool ended_ = false;
  std::shared_ptr<EpisodeReplay> asked_;  // last, of the own thread: it alone holds maps
  std::thread thread_;
};

}  // namespace lapwing
