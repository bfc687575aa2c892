// SPDX-License-Identifier: Apache-2.0
// A studio's session: pages, the document, and the working processes, on one thread.
//
// It never solves and runs no script. A gesture is checked by a working process, written into the
// journal, told to every page, and solved; while it is checked it is solved already, but no answer
// leaves before it has a revision. An answer is told only where it is the newest solve's, so that a
// certificate is never shown with a plan or a revision that it is not about.
#pragma once

#include <chrono>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "framework/studio/blob_store.h"
#include "framework/studio/document.h"
#include "framework/studio/event_loop.h"
#include "framework/studio/journal.h"
#include "framework/studio/page_message.h"
#include "framework/studio/web_server.h"
#include "framework/studio/worker_link.h"

namespace lapwing {

struct SessionSettings {
  std::filesystem::path script;
  std::string token;                      // of the address
  std::filesystem::path backdrop;         // a raster beneath the scene; empty: none
  std::vector<std::string> run_words;     // `lapwing run SCRIPT --json ...`, for reports
  Value laid = Value::map();              // of --config and --set: the first edit, if it is one
  std::chrono::milliseconds glance{250};  // between looks at the script
  std::chrono::milliseconds pause{150};   // after a gesture, before the layer is written
  // How long a drag waits for the first answer of the move before, so that quick moves are drawn.
  std::chrono::milliseconds patience{1000};
};

enum class WorkerRole { solver, checker, errands };
const char* to_string(WorkerRole role);

class StudioSession {
 public:
  // Without a journal nothing can be edited, and `why_not` says why.
  StudioSession(EventLoop& loop, SessionSettings settings, std::unique_ptr<Journal> journal,
                std::string why_not);
  ~StudioSession();

  // In place of the settings' one, before a page comes.
  void set_token(std::string token) { settings_.token = std::move(token); }
  // Asks for the script's options. The workers outlive the session.
  void begin(Worker& solver, Worker& checker, Worker& errands);
  // Writes the layer if it waits.
  void finish();

  // Pages.
  void opened(const std::shared_ptr<PageSocket>& page);
  void received(PageSocket& page, std::string_view text);
  void closed(PageSocket& page);
  std::shared_ptr<const std::string> blob(std::string_view name) {
    for (BlobStore* store : {&surfaces_, &backdrops_})
      if (auto found = store->find(name)) return found;
    return pictures_.find(name);
  }

  // Workers.
  void heard(WorkerRole role, Frame frame);
  void started(WorkerRole role);
  void crashed(WorkerRole role, const std::string& why);

  const std::optional<StudioDocument>& document() const { return document_; }

 private:
  using Clock = std::chrono::steady_clock;

  struct Page {
    std::shared_ptr<PageSocket> socket;
    std::string tab;
    bool greeted = false, welcomed = false;
  };
  // A change of the document on its way: checked, then committed.
  struct Proposal {
    EntryKind kind = EntryKind::gesture;
    Gesture gesture;
    std::optional<Value> next;    // what is proposed, where it does not follow from `gesture`
    std::optional<Value> script;  // of kind `script`
    StudioDocument::Take take = StudioDocument::Take::mine;
    PageSocket* from = nullptr;  // null: nobody, or gone
    std::size_t bytes = 0;       // of the message that it came with
    bool quiet = false;          // a layer or a script that was found: no page waits for it
    bool of_words = false;       // what the command line lays on the document
  };
  struct Check {
    std::int64_t serial = 0;
    bool of_script = false;  // of its options alone, or of a proposal
    Proposal proposal = {};
    Frame frame = {};
    int crashes = 0;         // of a process that was at it
    std::int64_t solve = 0;  // that began with it
  };
  struct Solve {
    std::int64_t serial = 0;
    std::string layer;                      // as JSON
    std::optional<std::uint64_t> revision;  // of the document; none of a preview
    std::uint64_t base = 0;                 // the revision that a preview is laid on
    bool settled = true;                    // of the document, as it is or will be; else a preview
    std::uint64_t edit = 0;                 // of a preview
    std::string tab;                        // likewise
    bool held = false;                      // of a proposal that has no revision yet
    Clock::time_point came, posted;         // the edit; the solve
    int rank = -1;                          // of the best answer so far
    int crashes = 0;                        // of a process that was at it
    Frame frame = {};
    std::vector<Frame> answers = {};       // the last of each rank
    std::vector<std::string> images = {};  // of an exploration so far, without a revision
    bool paused = false;
  };
  struct Errand {
    std::int64_t serial = 0;
    PageMessageType type = PageMessageType::fly;
    PageSocket* from = nullptr;
    PageMessage message = {};
    Frame frame = {};
    int crashes = 0;
  };
  // Of one working process, one after the other.
  struct ErrandLine {
    std::deque<Errand> queue = {};
    bool under_way = false;  // the first of them
  };
  // What a document ended with, to be shown again where it comes back, as by undo.
  struct Remembered {
    std::string layer;  // as JSON
    Frame answer = {};
    std::string world;
    std::vector<std::string> blobs = {};  // that it names
    std::size_t bytes = 0;
  };
  // What a page may fly, draw and export.
  struct Settled {
    std::string document;  // plan.json
    Value layer;
    std::uint64_t revision = 0;
    std::string folder = {};  // of the files that planning wrote and the plan names; or none
    std::vector<std::string> further = {};  // documents of the tours after the first one
  };

  // session.cpp: pages
  void ask_for_description();
  void greet(PageSocket& page, const PageMessage& message);
  void welcome(Page& page);
  void welcome_all();
  void take(PageSocket& page, const PageMessage& message);
  std::string welcome_text() const;
  Value mission_value() const;
  void tell(PageSocket* page, const Value& message);
  void tell_all(const std::string& text, bool replaceable = false);
  void tell_all(const Value& message);
  void tell_mission();
  void refuse(PageSocket* page, const PageMessage& message, const std::string& why);
  void refuse_gesture(const Proposal& proposal, const std::string& why);
  void fail(PageSocket* page, const PageMessage& message, const std::string& why);
  bool editable() const;
  std::string why_not() const;

  // session_document.cpp: changes of the document and of the script
  void propose(Proposal proposal);
  bool take_in(Proposal& proposal);  // or answered: as many wait as may
  void advance();
  Value next_of(const Proposal& proposal) const;
  void checked(const Frame& frame);
  void not_checked(const Frame& frame);
  void found_script(const Value& options);
  void begin_document(const Value& options);
  void look_at(const Value& options);
  void adopt_layer();
  void commit(const Check& check, const Value& next);
  void acknowledge(const Proposal& proposal);
  void check_script();
  void watch(const Frame& frame);
  void watch(const Value* files, bool all, std::set<std::filesystem::path>& watched);
  std::string look_of_all() const;
  void remark(const std::string& what);
  void remark_words(const std::string& why);
  void glance();
  void lay_words();
  void layer_changed();
  std::string write_layer_now();  // "" or why it could not be
  const Value& base_options() const;
  Value document_layer() const;

  // session_solving.cpp: solves, answers, errands
  void preview(PageSocket& page, const PageMessage& message);
  void rest();
  void post_solve(const Value& layer, Solve solve);
  void drag(const Value& layer, Solve solve);
  void drag_on();
  void solve_document(bool anew = false);
  void document_changed(std::int64_t solved_meanwhile);
  void answered(Frame frame);
  void deliver(const Frame& frame);
  const Remembered* remembered(const std::string& layer) const;
  bool is_whole(const Remembered& shown) const;
  void remember(const Frame& frame);
  void show_again(const Remembered& shown);
  void settle(const Frame& frame);
  void world(const Frame& frame);
  void progress(const Frame& frame);
  void estimated(const Frame& frame);
  void took_image(Frame frame);
  std::string image_text(const std::string& image) const;
  void pace(Pace pace);
  std::string pace_text() const;
  void first_flight(const Frame& frame);
  void solver_started();
  void add_errand(PageSocket& page, const PageMessage& message);
  Frame errand_frame(const PageMessage& message);
  void add_look(const PageMessage& message, Frame& frame) const;
  void add_map(const PageMessage& message, Frame& frame) const;
  void ask_for_backdrop();
  bool tell_backdrop(const Errand& errand, Frame& frame);
  void next_errand(WorkerRole role);
  void errand_done(WorkerRole role, Frame frame);
  void errands_started(WorkerRole role);
  std::string answer_of_errand(const Errand& errand, Frame frame);

  EventLoop& loop_;
  SessionSettings settings_;
  std::unique_ptr<Journal> journal_;
  std::string why_not_;
  Worker *solver_ = nullptr, *checker_ = nullptr, *errands_ = nullptr;
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);

  std::map<PageSocket*, Page> pages_;
  std::optional<StudioDocument> document_;
  std::optional<Value> pending_script_;  // changed on disk, and nobody said yet what is to hold
  std::string script_error_;
  int error_line_ = 0;
  std::string mission_name_, mission_kind_;
  std::string description_;  // schema and choices, as members of an object
  std::deque<Check> checks_;
  bool layer_waits_ = false;
  std::set<WorkerRole> crashed_;  // and not started again yet

  std::optional<Solve> solve_, next_drag_;  // the second waits for an answer of the first
  std::optional<Settled> certified_, settled_, displayed_;
  std::string document_answer_;  // the last one of the document as it is
  int document_rank_ = -1;
  std::string world_;                     // the last one told
  std::vector<std::string> world_blobs_;  // that it names
  BlobStore surfaces_{std::size_t{512} << 20}, pictures_{std::size_t{64} << 20};
  BlobStore backdrops_{1};  // the one that was told last alone, for pages that come later
  // The solving process answers what is asked about its plans.
  std::map<WorkerRole, ErrandLine> errand_lines_{{WorkerRole::errands, {}},
                                                 {WorkerRole::solver, {}}};
  std::string backdrop_looks_;    // of its file, when it was asked for last
  std::string backdrop_message_;  // the last one told
  std::int64_t serial_ = 0;
  std::deque<Remembered> remembered_;             // of the script as it is; the newest first
  std::set<std::filesystem::path> script_files_;  // that the script requires
  std::set<std::filesystem::path> data_files_;    // that the mission has read
  std::string watched_;                           // what the script's files looked like
  std::string told_mission_;                      // as JSON; "" before the first page
  std::vector<std::string> remarks_;              // of the start, for every page
};

}  // namespace lapwing
