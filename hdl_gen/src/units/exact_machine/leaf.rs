//! The leaf check, and the hit that it answers.

use super::{Build, Entry, Ports};
use crate::netlist::Wire;
use rtl_model::units::bounded_datapaths::BoundedDatapath;

impl Build<'_> {
    /// The leaf check, from the FIFO to the hit.
    pub(super) fn leaf(&mut self, entry: &Entry, trip: &Ports, waiting: &Ports) {
        let shape = self.shape;
        let names_at = |place| {
            let registers = shape.leaf_walk_registers(place).into_iter();
            registers.map(|(name, _)| name).collect::<Vec<&str>>()
        };
        let walk_names = names_at("waiting");
        let ray_names: Vec<&str> = shape.leaf_ray_registers().iter().map(|&(n, _)| n).collect();
        self.b
            .section("the ray at the texel's depth, and the error term, digit by digit");
        let check_valid = self.get("check_valid");
        let turns = self.get("check_turns");
        let is_known = self.get("check_corner_is_known");
        let has_travel = self.reaches(turns, shape.travel_turns());
        let has_corner = self.reaches(turns, shape.corner_turns());
        let of_check = |this: &Self, name: &'static str| (name, this.get(&format!("check_{name}")));
        let names = ["slope_u", "slope_v", "travel_u", "travel_v", "depth_digits"];
        let inputs = names.map(|name| of_check(self, name));
        let digits = BoundedDatapath::LeafTravel(shape.effort.travel_digits);
        let travel = self.datapath(digits, "", &inputs);
        let names = ["slope_u", "slope_v", "corner_u", "corner_v", "error"];
        let inputs = names.map(|name| of_check(self, name));
        let digits = BoundedDatapath::LeafCorner(shape.effort.corner_digits);
        let corner = self.datapath(digits, "", &inputs);

        self.b.section("the verdict");
        let error = self.get("check_error");
        let error = match shape.corner_rest() {
            0 => error,
            rest => {
                let rest = BoundedDatapath::LeafCorner(rest);
                let width = self.b.width(error);
                let rest = self.datapath(rest, "_rest", &inputs);
                let rest = self.fit(rest.get("error_o"), width);
                self.b.mux(is_known, error, rest)
            }
        };
        let names = [
            "slope_u", "slope_v", "way_u", "way_v", "travel_u", "travel_v",
        ];
        let mut inputs: Vec<(&str, Wire)> = names.iter().map(|name| of_check(self, name)).collect();
        inputs.push(("error", error));
        let verdict = self.datapath(BoundedDatapath::LeafVerdict, "", &inputs);
        let is_before_none = self.b.not(verdict.get("is_before_o"));
        let suffices = self.b.or(has_corner, is_before_none);
        let suffices = self.b.or(suffices, is_known);
        let answer_valid = self.get("answer_valid");
        let is_free = self.b.not(answer_valid);
        let answers = self.all(&[check_valid, has_travel, suffices, is_free]);

        self.b
            .section("a walk waits for the leaf check, with its ray");
        let waiting_valid = self.get("waiting_valid");
        let not_checking = self.b.not(check_valid);
        let check_is_free = self.b.or(not_checking, answers);
        let checks = self.b.and(waiting_valid, check_is_free);
        let not_waiting = self.b.not(waiting_valid);
        let is_free = self.b.or(not_waiting, checks);
        let fetched_valid = self.get("fetched_valid");
        let waits = self.b.and(fetched_valid, is_free);
        let not_fetched = self.b.not(fetched_valid);
        let is_free = self.b.or(not_fetched, waits);
        let fetches = self.b.and(waiting.get("out_valid_o"), is_free);
        self.wires.put("fetches", fetches);
        let not_waiting = self.b.not(waits);
        let stays = self.b.and(fetched_valid, not_waiting);
        let next = self.b.or(fetches, stays);
        self.b.connect(fetched_valid, next);
        let not_checked = self.b.not(checks);
        let stays = self.b.and(waiting_valid, not_checked);
        let next = self.b.or(waits, stays);
        self.b.connect(waiting_valid, next);
        let slot = waiting.get("out_slot_o");
        let new_slot = self.get("new_slot");
        let last = shape.setup_places() - 1;
        let set_up: Vec<Wire> = ray_names
            .iter()
            .map(|name| self.get(&format!("setup_{last}_{name}")))
            .collect();
        let admits = (entry.admits, new_slot);
        let ray = self.read_memory("leaf_rays", &set_up, admits, (fetches, slot));
        self.b.name(ray[0], "fetched_id");
        for (name, &wire) in ray_names.iter().zip(&ray) {
            self.load(&format!("waiting_{name}"), wire, waits);
        }
        let registers = shape.leaf_walk_registers("waiting");
        let fields: Vec<Wire> = registers[1..]
            .iter()
            .map(|&(name, width)| {
                let port = match name {
                    "texel_u" => "i_o".to_owned(),
                    "texel_v" => "j_o".to_owned(),
                    name => format!("{name}_o"),
                };
                self.fit(trip.get(&port), width)
            })
            .collect();
        let ends = (self.get("ends"), trip.get("slot"));
        let walk = self.read_memory("ended_walks", &fields, ends, (fetches, slot));
        for (name, &wire) in walk_names[1..].iter().zip(&walk) {
            self.load(&format!("waiting_{name}"), wire, waits);
        }
        self.load("fetched_slot", slot, fetches);
        let fetched_slot = self.get("fetched_slot");
        self.load("waiting_slot", fetched_slot, waits);

        self.b.section("the check begins, and goes on");
        let checked = ["id", "slope_u", "slope_v", "mirror_u", "mirror_v"];
        for name in names_at("check").iter().chain(&checked) {
            let wire = self.get(&format!("waiting_{name}"));
            self.load(&format!("check_{name}"), wire, checks);
        }
        let inputs = [
            ("mirrored_u", "mirrored_u"),
            ("mirrored_v", "mirrored_v"),
            ("i", "texel_u"),
            ("j", "texel_v"),
            ("slope_u", "slope_u"),
            ("slope_v", "slope_v"),
            ("corner_is_known", "corner_is_known"),
            ("v_is_later", "v_is_later"),
        ];
        let inputs = inputs.map(|(name, of)| (name, self.get(&format!("waiting_{of}"))));
        let ways = self.datapath(BoundedDatapath::LeafEntry, "", &inputs);
        let not_travelled = self.b.not(has_travel);
        let travels = self.b.and(check_valid, not_travelled);
        let not_turned = self.b.not(has_corner);
        let turns_corner = self.b.and(check_valid, not_turned);
        let turns_on = self.b.or(travels, turns_corner);
        let is_unknown = self.b.not(is_known);
        let corners = self.b.and(turns_corner, is_unknown);
        let one_more = self.next_number(turns);
        let none = self.b.constant(0, self.b.width(turns));
        let next = self.b.mux(checks, none, one_more);
        let changes = self.b.or(checks, turns_on);
        self.b.connect_enabled(turns, next, changes);
        for axis in ["u", "v"] {
            let way = ways.get(&format!("way_{axis}_o"));
            self.load(&format!("check_way_{axis}"), way, checks);
        }
        let depth = self.get("waiting_depth");
        let depth = self
            .b
            .zero_extend(depth, shape.bounded.words.height_bits + 1);
        let starts = [
            ("travel_u", ways.get("way_u_o")),
            ("travel_v", ways.get("way_v_o")),
            ("depth_digits", depth),
        ];
        self.turn(&starts, &travel, checks, travels);
        let starts = ["corner_u", "corner_v", "error"];
        let starts = starts.map(|name| (name, ways.get(&format!("{name}_o"))));
        self.turn(&starts, &corner, checks, corners);
        let not_answered = self.b.not(answers);
        let stays = self.b.and(check_valid, not_answered);
        let next = self.b.or(checks, stays);
        self.b.connect(check_valid, next);

        self.b.section("what is answered");
        for name in names_at("answer")
            .iter()
            .chain(&["id", "mirror_u", "mirror_v"])
        {
            let wire = self.get(&format!("check_{name}"));
            self.load(&format!("answer_{name}"), wire, answers);
        }
        let mut refused = verdict.get("refused_o");
        if shape.counters {
            let guard = self.get("check_guard");
            let no_guard = self.b.not(guard);
            refused = self.b.and(refused, no_guard);
        }
        self.load("answer_refused", refused, answers);
        let at_border_v = verdict.get("at_border_v_o");
        self.load("answer_at_border_u", verdict.get("at_border_u_o"), answers);
        self.load("answer_at_border_v", at_border_v, answers);
        for (name, of_axis) in [("way", "check_way"), ("slope", "check_slope")] {
            let on = |this: &Self, axis: &str| this.get(&format!("{of_axis}_{axis}"));
            let (u, v) = (on(self, "u"), on(self, "v"));
            let chosen = self.b.mux(at_border_v, v, u);
            self.load(&format!("answer_{name}"), chosen, answers);
        }

        self.b
            .section("the answer: a hit, or the walk goes back into the loop");
        let not_refused = self.b.not(self.wires.get("answer_refused"));
        let hit_valid = self.b.and(answer_valid, not_refused);
        let taken = self.b.and(hit_valid, self.wires.get("hit_ready_i"));
        let leaves = self.b.or(taken, entry.returns);
        let remains = self.b.not(leaves);
        let stays = self.b.and(answer_valid, remains);
        let next = self.b.or(answers, stays);
        self.b.connect(answer_valid, next);
        self.b.output("hit_valid_o", hit_valid);
        for (name, width) in shape.hit_fields() {
            let register = match name {
                "i" => "texel_u",
                "j" => "texel_v",
                name => name,
            };
            let mut wire = self.get(&format!("answer_{register}"));
            if let "i" | "j" = name {
                wire = self.b.slice(wire, width - 1, 0);
                let axis = if name == "i" { "u" } else { "v" };
                let mirror = self.get(&format!("answer_mirror_{axis}"));
                let mirror = self.b.sign_extend(mirror, width);
                wire = self.b.xor(wire, mirror);
                if shape.bounded.words.root_level == 0 {
                    wire = self.b.constant(0, 1);
                }
            }
            self.b.output(&format!("hit_{name}_o"), wire);
        }

        self.b
            .section("slots: taken by a new ray, free when its hit is taken");
        let free_slots = self.get("free_slots");
        let slots = shape.effort.slots;
        let none = self.b.constant(0, slots);
        let taken_slot = self.b.mux(entry.admits, self.wires.get("slot_taken"), none);
        let kept = self.b.not(taken_slot);
        let kept = self.b.and(free_slots, kept);
        let slot = self.get("answer_slot");
        let bits: Vec<Wire> = (0..slots)
            .rev()
            .map(|number| {
                let number = self.b.constant(number.into(), shape.slot_bits());
                let is_this = self.b.equal(slot, number);
                self.b.and(is_this, taken)
            })
            .collect();
        let freed = self.b.concat(&bits);
        let next = self.b.or(kept, freed);
        self.b.connect(free_slots, next);
    }

    /// Registers of the check that begin so and go on so.
    pub(super) fn turn(
        &mut self,
        starts: &[(&str, Wire)],
        after: &Ports,
        begins: Wire,
        goes_on: Wire,
    ) {
        let changes = self.b.or(begins, goes_on);
        for &(name, start) in starts {
            let register = self.get(&format!("check_{name}"));
            let width = self.b.width(register);
            let start = self.fit(start, width);
            let turned = self.fit(after.get(&format!("{name}_o")), width);
            let next = self.b.mux(begins, start, turned);
            self.b.connect_enabled(register, next, changes);
        }
    }
}
