//! The chain of setups: each makes its share of a ray's digits.

use super::{Build, Ports};
use crate::netlist::Wire;
use rtl_model::units::bounded_datapaths::BoundedDatapath;
use rtl_model::units::bounded_setup::{near_sum_bits, near_sum_start};

impl Build<'_> {
    /// The setups; answers what leaves the last, and `is_set_up`.
    pub(super) fn setups(&mut self) -> Ports {
        let shape = self.shape;
        let setups = shape.setup_places();
        let makes_digits = |setup: usize| !shape.only_waits(setup as u32);
        let multiplies = shape.effort.setups as usize;
        let ray_names: Vec<&str> = shape.ray_registers().iter().map(|&(n, _)| n).collect();

        self.b.section("which setups are done, and which are free");
        let fresh = self.get("fresh_s0");
        let mut done = Vec::new();
        let mut running = Vec::new();
        for n in 0..setups {
            let busy = self.get(&format!("setup_{n}_busy"));
            if !makes_digits(n as usize) {
                // A ray only waits here.
                done.push(busy);
                running.push(fresh);
                continue;
            }
            let turns = self.get(&format!("setup_{n}_turns"));
            let runs = self.b.any_bit(turns);
            let rests = self.b.not(runs);
            done.push(self.b.and(busy, rests));
            running.push(runs);
        }
        let not_fresh = self.b.not(fresh);
        let last = setups as usize - 1;
        let is_set_up = self.b.and(done[last], not_fresh);
        let mut free = vec![fresh; setups as usize];
        for n in (0..setups as usize).rev() {
            let busy = self.get(&format!("setup_{n}_busy"));
            let idle = self.b.not(busy);
            let leaves = match n == last {
                true => fresh,
                false => self.b.and(done[n], free[n + 1]),
            };
            free[n] = self.b.or(idle, leaves);
        }
        self.b.output("ray_ready_o", free[0]);

        for n in 0..setups as usize {
            self.b.section(match makes_digits(n) {
                true => format!("setup {n}"),
                false => format!("setup {n}: a ray that is set up waits"),
            });
            let offered = match n {
                0 => self.get("ray_valid_i"),
                _ => done[n - 1],
            };
            let loads = self.b.and(offered, free[n]);
            let busy = self.get(&format!("setup_{n}_busy"));
            let not_free = self.b.not(free[n]);
            let stays = self.b.and(busy, not_free);
            let next = self.b.or(loads, stays);
            self.b.connect(busy, next);
            let mut changes = loads;
            if makes_digits(n) {
                let turns = self.get(&format!("setup_{n}_turns"));
                let width = self.b.width(turns);
                let all = self.b.constant(shape.setup_turns(n as u32).into(), width);
                let one = self.b.constant(1, width);
                let fewer = self.b.subtract(turns, one);
                let next = self.b.mux(loads, all, fewer);
                changes = self.b.or(loads, running[n]);
                self.b.connect_enabled(turns, next, changes);
            }

            // What a ray brings along.
            let mut loaded = Ports::default();
            if n == 0 {
                let ports = [
                    ("u", self.get("ray_u_i")),
                    ("v", self.get("ray_v_i")),
                    ("du", self.get("ray_du_i")),
                    ("dv", self.get("ray_dv_i")),
                ];
                let entry = self.datapath(BoundedDatapath::SetupEntry, "", &ports);
                for name in &ray_names {
                    let wire = match *name {
                        "id" => self.get("ray_id_i"),
                        "texel_u" => entry.get("i_o"),
                        "texel_v" => entry.get("j_o"),
                        name => entry.get(&format!("{name}_o")),
                    };
                    loaded.put(*name, wire);
                }
                for axis in ["u", "v"] {
                    for name in ["saturates", "behind", "remainder", "first_saturates"] {
                        let wire = entry.get(&format!("{name}_{axis}_o"));
                        loaded.put(format!("{name}_{axis}"), wire);
                    }
                }
            } else {
                for name in &ray_names {
                    loaded.put(*name, self.get(&format!("setup_{}_{name}", n - 1)));
                }
                for axis in ["u", "v"] {
                    self.handed_on(n as u32 - 1, axis, &mut loaded);
                }
            }
            for name in &ray_names {
                self.load(&format!("setup_{n}_{name}"), loaded.get(name), loads);
            }
            for axis in ["u", "v"] {
                let after = match makes_digits(n) {
                    true => self.digits(n as u32, axis),
                    false => Ports::default(),
                };
                for &(name, width) in &shape.setup_registers(n as u32) {
                    let register = self.get(&format!("setup_{n}_{name}_{axis}"));
                    let turned = match name {
                        "digits" => Some("quotient_o"),
                        "remainder" => Some("remainder_o"),
                        "behind" if n == multiplies => Some("behind_o"),
                        "sum" => Some("sum_o"),
                        _ => None,
                    };
                    let turned = turned.map(|port| {
                        let wire = after.get(port);
                        self.fit(wire, width)
                    });
                    // The digits of the ray before are shifted out.
                    let start = (name != "digits").then(|| loaded.get(&format!("{name}_{axis}")));
                    let start = start.map(|start| self.fit(start, width));
                    match (start, turned) {
                        (Some(start), Some(turned)) => {
                            let next = self.b.mux(loads, start, turned);
                            self.b.connect_enabled(register, next, changes);
                        }
                        (Some(start), None) => self.b.connect_enabled(register, start, loads),
                        (None, turned) => {
                            let turned = turned.expect("digits are made");
                            let shifts = self.only_running(running[n], loads);
                            self.b.connect_enabled(register, turned, shifts);
                        }
                    }
                }
            }
        }

        self.b.section("a ray that is set up");
        let mut set_up = Ports::default();
        set_up.put("is_set_up", is_set_up);
        for name in &ray_names {
            set_up.put(*name, self.get(&format!("setup_{last}_{name}")));
        }
        for axis in ["u", "v"] {
            if makes_digits(last) {
                self.handed_on(last as u32, axis, &mut set_up);
                continue;
            }
            for name in ["t_delta", "t_near"] {
                let wire = self.get(&format!("setup_{last}_{name}_{axis}"));
                set_up.put(format!("{name}_{axis}"), wire);
            }
        }
        for axis in ["u", "v"] {
            // A bit for the sign.
            let name = format!("t_delta_{axis}");
            let t_delta = set_up.get(&name);
            let t_delta = self.b.zero_extend(t_delta, shape.bounded.delta_bits() + 1);
            set_up.put(name, t_delta);
        }
        set_up
    }

    /// Turns, and is not loaded.
    fn only_running(&mut self, runs: Wire, loads: Wire) -> Wire {
        let not_loaded = self.b.not(loads);
        self.b.and(runs, not_loaded)
    }

    /// What an axis of a setup gives to the next.
    fn handed_on(&mut self, setup: u32, axis: &str, loaded: &mut Ports) {
        let shape = self.shape;
        let of_axis = |name: &str| format!("setup_{setup}_{name}_{axis}");
        if shape.only_waits(setup) {
            for name in ["t_delta", "t_near"] {
                loaded.put(format!("{name}_{axis}"), self.get(&of_axis(name)));
            }
            return;
        }
        if setup == shape.effort.setups {
            let names = ["saturates", "quotient", "behind", "sum"];
            let mut inputs = names.map(|name| (name, self.get(&of_axis(name))));
            for input in &mut inputs[1..3] {
                // A bit for the sign.
                input.1 = self.b.zero_extend(input.1, self.b.width(input.1) + 1);
            }
            let digits = BoundedDatapath::SetupEnd(shape.near_digits());
            let end = self.datapath(digits, "", &inputs);
            let t_delta = self.fit(end.get("t_delta_o"), shape.bounded.delta_bits());
            loaded.put(format!("t_delta_{axis}"), t_delta);
            let t_near = self.fit(end.get("t_near_o"), shape.bounded.bound_bits());
            loaded.put(format!("t_near_{axis}"), t_near);
            return;
        }
        for name in ["saturates", "behind", "remainder", "first_saturates"] {
            loaded.put(format!("{name}_{axis}"), self.get(&of_axis(name)));
        }
        let made = self.get(&of_axis("digits"));
        let made = match setup {
            0 => made,
            _ => {
                let before = self.get(&of_axis("digits_before"));
                self.b.concat(&[before, made])
            }
        };
        loaded.put(format!("digits_before_{axis}"), made);
        if setup + 1 == shape.effort.setups {
            let digits = shape.near_digits();
            let behind = self.get(&of_axis("behind"));
            let more = digits - shape.bounded.behind_bits();
            let behind = match more {
                0 => behind,
                more => {
                    let zeros = self.b.constant(0, more);
                    self.b.concat(&[behind, zeros])
                }
            };
            loaded.put(format!("behind_{axis}"), behind);
            loaded.put(format!("quotient_{axis}"), made);
            let bits = near_sum_bits(shape.bounded, digits);
            let start = near_sum_start(shape.bounded, digits) as u64;
            let start = self.b.constant(start & (u64::MAX >> (64 - bits)), bits);
            loaded.put(format!("sum_{axis}"), start);
        }
    }

    /// An axis of a setup after its digits of a cycle.
    fn digits(&mut self, setup: u32, axis: &str) -> Ports {
        let shape = self.shape;
        let get = |this: &Self, name: &str| this.get(&format!("setup_{setup}_{name}_{axis}"));
        if setup == shape.effort.setups {
            let datapath =
                BoundedDatapath::SetupNear(shape.effort.near_digits, shape.near_digits());
            let quotient = get(self, "quotient");
            let behind = get(self, "behind");
            let inputs = [
                (
                    "quotient",
                    self.b.zero_extend(quotient, shape.bounded.delta_bits() + 1),
                ),
                (
                    "behind",
                    self.b.zero_extend(behind, shape.near_digits() + 1),
                ),
                ("sum", get(self, "sum")),
            ];
            return self.datapath(datapath, "", &inputs);
        }
        let rest = shape.bounded.words.slope_bits + 1;
        let (remainder, made) = (get(self, "remainder"), get(self, "digits"));
        let inputs = [
            ("slope", self.get(&format!("setup_{setup}_slope_{axis}"))),
            ("remainder", self.b.zero_extend(remainder, rest)),
            ("first_saturates", get(self, "first_saturates")),
            (
                "quotient",
                self.b.zero_extend(made, shape.bounded.delta_bits() + 1),
            ),
        ];
        self.datapath(BoundedDatapath::SetupDigits(1), "", &inputs)
    }
}
