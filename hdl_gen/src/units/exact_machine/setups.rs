//! The chain of setups: each makes its share of a ray's digits.

use super::{Build, Ports};
use rtl_model::units::bounded_datapaths::BoundedDatapath;

impl Build<'_> {
    /// The setups; answers what leaves the last, and `is_set_up`.
    pub(super) fn setups(&mut self) -> Ports {
        let shape = self.shape;
        let setups = shape.setup_places();
        let makes_digits = |setup: usize| !shape.only_waits(setup as u32);
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
            let division = shape.division_registers_of(n as u32);
            let division_names: Vec<&str> = division.iter().map(|&(name, _)| name).collect();
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
                let texel = 1 << shape.bounded.words.entry_fraction_bits;
                for axis in ["u", "v"] {
                    for &(name, width) in &shape.division_registers() {
                        let wire = match name {
                            "delta_remainder" => self.b.constant(texel, width),
                            "first_remainder" => entry.get(&format!("first_way_{axis}_o")),
                            "t_delta" | "t_near" => self.b.constant(0, width),
                            name => entry.get(&format!("{name}_{axis}_o")),
                        };
                        loaded.put(format!("{name}_{axis}"), wire);
                    }
                }
            } else {
                for name in &ray_names {
                    loaded.put(*name, self.get(&format!("setup_{}_{name}", n - 1)));
                }
                let makes_rest = n as u32 == shape.effort.setups && shape.setup_rest() > 0;
                for axis in ["u", "v"] {
                    let rest =
                        makes_rest.then(|| self.digits(n - 1, axis, shape.setup_rest(), "_rest"));
                    for name in &division_names {
                        let wire = match &rest {
                            Some(after) => after.get(&format!("{name}_o")),
                            None => self.get(&format!("setup_{}_{name}_{axis}", n - 1)),
                        };
                        loaded.put(format!("{name}_{axis}"), wire);
                    }
                }
            }
            for name in &ray_names {
                self.load(&format!("setup_{n}_{name}"), loaded.get(name), loads);
            }
            for axis in ["u", "v"] {
                let after = match makes_digits(n) {
                    true => self.digits(n, axis, shape.effort.setup_digits, ""),
                    false => Ports::default(),
                };
                for name in &division_names {
                    let register = self.get(&format!("setup_{n}_{name}_{axis}"));
                    let width = self.b.width(register);
                    let start = self.fit(loaded.get(&format!("{name}_{axis}")), width);
                    // What a digit does not change is but loaded.
                    let is_unchanged =
                        ["delta_saturates", "first_saturates", "texels_back"].contains(name);
                    if is_unchanged || !makes_digits(n) {
                        self.b.connect_enabled(register, start, loads);
                        continue;
                    }
                    let turned = self.fit(after.get(&format!("{name}_o")), width);
                    let next = self.b.mux(loads, start, turned);
                    self.b.connect_enabled(register, next, changes);
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
            let (t_delta, t_near) = match shape.setup_rest() {
                rest if rest > 0 && makes_digits(last) => {
                    let after = self.digits(last, axis, rest, "_rest");
                    (after.get("t_delta_o"), after.get("t_near_o"))
                }
                _ => (
                    self.get(&format!("setup_{last}_t_delta_{axis}")),
                    self.get(&format!("setup_{last}_t_near_{axis}")),
                ),
            };
            let t_near = self.fit(t_near, shape.bounded.bound_bits());
            let upper = self.datapath(BoundedDatapath::SetupEnd, "", &[("t_near", t_near)]);
            let t_delta = self.fit(t_delta, shape.bounded.delta_bits() + 1);
            set_up.put(format!("t_delta_{axis}"), t_delta);
            let t_near = self.fit(upper.get("t_near_o"), shape.bounded.bound_bits());
            set_up.put(format!("t_near_{axis}"), t_near);
        }
        set_up
    }

    /// The division of a setup on an axis after so many digits.
    pub(super) fn digits(&mut self, setup: usize, axis: &str, count: u32, suffix: &str) -> Ports {
        let names = self.shape.division_registers();
        let slope = self.get(&format!("setup_{setup}_slope_{axis}"));
        let mut inputs = vec![("slope", slope)];
        for &(name, _) in &names {
            inputs.push((name, self.get(&format!("setup_{setup}_{name}_{axis}"))));
        }
        self.datapath(BoundedDatapath::SetupDigits(count), suffix, &inputs)
    }
}
