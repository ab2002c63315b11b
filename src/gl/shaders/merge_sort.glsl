// Merge sort of a linked list from the bottom up, in place. Before this are defined: kNoItem, and
//   uint next_of(uint item);  void set_next(uint item, uint next);  bool is_before(uint a, uint b);
//
// Long lists are sorted a doubling of the runs a pass, so that the iterations of loops in one invocation are bounded
// (docs/methods/opengl.md).

const uint kMostShort = 1000u;   // items of a list that is sorted at once
const uint kMostItems = 20000u;  // of one that can be sorted at all

uint count_items(uint head, uint most) {
  uint count = 0u;
  for (uint item = head; item != kNoItem && count < most; item = next_of(item)) ++count;
  return count;
}

// Merges neighbouring runs of so many items; how many pairs there were.
uint merge_runs(uint run, inout uint head) {
  uint left = head, tail = kNoItem, merges = 0u;
  head = kNoItem;
  while (left != kNoItem) {
    ++merges;
    uint right = left, left_count = 0u;
    while (left_count < run && right != kNoItem) {
      right = next_of(right);
      ++left_count;
    }
    uint right_count = run;
    while (left_count > 0u || (right_count > 0u && right != kNoItem)) {
      bool takes_left = left_count > 0u && (right_count == 0u || right == kNoItem || !is_before(right, left));
      uint taken = takes_left ? left : right;
      if (takes_left) {
        left = next_of(left);
        --left_count;
      } else {
        right = next_of(right);
        --right_count;
      }
      if (tail == kNoItem)
        head = taken;
      else
        set_next(tail, taken);
      tail = taken;
    }
    left = right;
  }
  set_next(tail, kNoItem);
  return merges;
}

// What comes of a pass for one list.
const int kSorted = 0, kNeedsAnother = 1, kTooLong = 2;

// One pass: the first (`run` 0) sorts short lists, later ones double the runs of long lists, from 1 on.
int sort_pass(uint run, inout uint head) {
  uint count = count_items(head, run == 0u ? kMostShort + 1u : kMostItems + 1u);
  if (run == 0u) {
    if (count > kMostShort) return kNeedsAnother;
    for (uint length = 1u; length < count; length *= 2u) merge_runs(length, head);
    return kSorted;
  }
  if (count <= kMostShort) return kSorted;
  if (count > kMostItems) return kTooLong;
  return merge_runs(run, head) > 1u ? kNeedsAnother : kSorted;
}
