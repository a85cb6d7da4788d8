//! The order of steps: first what most others wait for, as long as registers last.
//!
//! A processor looks some hundred instructions ahead. Polynomials of sines and the elimination of a Newton step are chains in which each
//! instruction waits for the one before; a tape holds one such chain after the other. Taken in turns, they fill each other's waits. The
//! values are the same: each step has the operands that it had.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::Vectors;
use super::encode::Packed;
use super::lower::{Step, Value};

/// Longer code keeps its order: the search for the next step goes through all that could be taken.
const MOST_STEPS: usize = 4_000;
/// Registers that the values which wait may not fill: for operands that are read from memory, and for what is underway.
const SPARE: usize = 4;
/// Steps that a processor with two units for products and sums starts in a cycle.
const WIDTH: u32 = 2;

/// The same steps without those that nothing uses, in an order that waits less. Code that calls functions keeps its order, as all
/// registers go to memory there.
pub(super) fn ordered(steps: Vec<Step>, vectors: Vectors) -> Vec<Step> {
    if steps.len() > MOST_STEPS || steps.iter().any(|step| matches!(step, Step::Call(..))) {
        return steps;
    }
    Schedule::new(&steps).run(vectors.registers() - SPARE)
}

/// Cycles from the operands to the value.
fn latency(step: Step) -> u32 {
    match step {
        Step::Input(_) | Step::Scalar(_) | Step::Store(..) => 0,
        Step::Packed(Packed::Divide, ..) => 16,
        Step::SquareRoot(_) => 24,
        Step::Packed(Packed::And | Packed::ExclusiveOr, ..) | Step::Shift(..) => 1,
        Step::Select { .. } => 2,
        Step::Packed(..) | Step::Unordered(..) | Step::Call(..) => 4,
    }
}

/// What is read from memory where it is used: nothing to wait for, and no register that has to be kept.
fn is_read(step: Step) -> bool {
    matches!(step, Step::Input(_) | Step::Scalar(_))
}

fn is_store(step: Step) -> bool {
    matches!(step, Step::Store(..))
}

/// The values that a step uses, each once.
fn operands(step: Step) -> impl Iterator<Item = usize> {
    let [a, b, c] = step.operands();
    let b = b.filter(|_| b != a);
    let c = c.filter(|_| c != a && c != b);
    [a, b, c].into_iter().flatten().map(|value| value as usize)
}

/// A step whose operands have all been taken.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Ready {
    /// Cycles from its start to the end of the last one that waits for it.
    height: u32,
    step: Reverse<Value>,
    /// The cycle in which its operands are there.
    start: u32,
}

struct Schedule<'s> {
    steps: &'s [Step],
    /// Steps still to come that use each value.
    uses: Vec<u32>,
    /// How many values each step is the last to use, of those in registers.
    ends: Vec<u32>,
    is_taken: Vec<bool>,
    /// The steps that use each value, one range of `users` for each.
    first_user: Vec<u32>,
    users: Vec<Value>,
    /// Operands of each step that have not been computed yet.
    missing: Vec<u32>,
    height: Vec<u32>,
    /// The cycle in which each value is there.
    done: Vec<u32>,
    /// Those that need nothing but what is read from memory.
    first: BinaryHeap<Ready>,
    /// Those that need other values, which are in registers until then.
    open: Vec<Ready>,
    live: usize,
}

impl<'s> Schedule<'s> {
    fn new(steps: &'s [Step]) -> Schedule<'s> {
        let count = steps.len();
        let (mut uses, mut height, mut missing) = (vec![0_u32; count], vec![0_u32; count], vec![0_u32; count]);
        let mut first = Vec::new();
        for (k, step) in steps.iter().enumerate().rev() {
            if uses[k] == 0 && !is_store(*step) || is_read(*step) {
                continue;
            }
            height[k] += latency(*step);
            for operand in operands(*step) {
                uses[operand] += 1;
                height[operand] = height[operand].max(height[k]);
                missing[k] += u32::from(!is_read(steps[operand]));
            }
            if missing[k] == 0 {
                first.push(Ready { height: height[k], step: Reverse(k as Value), start: 0 });
            }
        }
        let mut first_user = vec![0_u32; count + 1];
        for k in 0..count {
            first_user[k + 1] = first_user[k] + uses[k];
        }
        let mut next = first_user.clone();
        let mut users = vec![0; first_user[count] as usize];
        for (k, step) in steps.iter().enumerate().filter(|(k, step)| uses[*k] > 0 || is_store(**step)) {
            for operand in operands(*step) {
                users[next[operand] as usize] = k as Value;
                next[operand] += 1;
            }
        }
        Schedule {
            steps,
            uses,
            ends: vec![0; count],
            is_taken: vec![false; count],
            first_user,
            users,
            missing,
            height,
            done: vec![0; count],
            first: BinaryHeap::from(first),
            open: Vec::new(),
            live: 0,
        }
    }

    fn run(mut self, registers: usize) -> Vec<Step> {
        let is_used = |k: &Value| is_read(self.steps[*k as usize]) && self.uses[*k as usize] > 0;
        let mut order: Vec<Value> = (0..self.steps.len() as Value).filter(is_used).collect();
        let mut started = 0;
        while let Some(next) = self.choose(started / WIDTH, self.live >= registers) {
            let from = next.start.max(started / WIDTH);
            self.take(next.step.0, from);
            if !is_store(self.steps[next.step.0 as usize]) {
                started = started.max(from * WIDTH) + 1;
            }
            order.push(next.step.0);
        }
        renumbered(self.steps, &order)
    }

    /// The step that is taken next.
    fn choose(&mut self, now: u32, is_full: bool) -> Option<Ready> {
        let worth = |ready: &Ready| {
            let growth = if is_full { self.growth(ready.step.0) } else { 0 };
            (Reverse(growth), Reverse(ready.start.saturating_sub(now)), ready.height, ready.step)
        };
        let open = (0..self.open.len()).map(|place| (worth(&self.open[place]), place)).max();
        let first = self.first.peek().map(worth);
        match open {
            Some((of_open, place)) if first.is_none_or(|first| of_open > first) => Some(self.open.swap_remove(place)),
            _ => self.first.pop(),
        }
    }

    /// How many registers more are kept after a step than before it.
    fn growth(&self, step: Value) -> i32 {
        i32::from(!is_store(self.steps[step as usize])) - self.ends[step as usize] as i32
    }

    fn users_of(&self, value: usize) -> &[Value] {
        &self.users[self.first_user[value] as usize..self.first_user[value + 1] as usize]
    }

    /// If a value has one use left, its register ends there.
    fn note_last_use(&mut self, value: usize) {
        if self.uses[value] == 1
            && let Some(user) = self.users_of(value).iter().copied().find(|user| !self.is_taken[*user as usize])
        {
            self.ends[user as usize] += 1;
        }
    }

    fn take(&mut self, step: Value, from: u32) {
        let kind = self.steps[step as usize];
        self.done[step as usize] = from + latency(kind);
        self.is_taken[step as usize] = true;
        self.live = (self.live + usize::from(!is_store(kind))) - self.ends[step as usize] as usize;
        for operand in operands(kind).filter(|value| !is_read(self.steps[*value])) {
            self.uses[operand] -= 1;
            self.note_last_use(operand);
        }
        self.note_last_use(step as usize);
        for place in self.first_user[step as usize]..self.first_user[step as usize + 1] {
            let user = self.users[place as usize];
            self.missing[user as usize] -= 1;
            if self.missing[user as usize] == 0 {
                let start = operands(self.steps[user as usize]).map(|value| self.done[value]).max().unwrap_or(0);
                self.open.push(Ready { height: self.height[user as usize], step: Reverse(user), start });
            }
        }
    }
}

/// The steps in this order, with their operands by their new numbers.
fn renumbered(steps: &[Step], order: &[Value]) -> Vec<Step> {
    let mut number = vec![0; steps.len()];
    for (new, old) in order.iter().enumerate() {
        number[*old as usize] = new as Value;
    }
    order.iter().map(|old| steps[*old as usize].with_operands(|value| number[value as usize])).collect()
}

#[cfg(test)]
mod tests {
    use super::super::lower::Target;
    use super::*;

    /// Chains of products, one after the other, each of which is stored.
    fn chains(count: usize, length: usize) -> Vec<Step> {
        let mut steps: Vec<Step> = Vec::new();
        for chain in 0..count {
            steps.push(Step::Input(chain as u32));
            for _ in 0..length {
                let last = (steps.len() - 1) as Value;
                steps.push(Step::Packed(Packed::Multiply, last, last));
            }
            let last = (steps.len() - 1) as Value;
            steps.push(Step::Store(Target::Output(chain as u32), last));
        }
        steps
    }

    /// Which products of each chain follow each other, by the number of their input.
    fn order(steps: &[Step]) -> Vec<u32> {
        let mut from: Vec<u32> = Vec::new();
        for step in steps {
            let own = match *step {
                Step::Input(block) => block,
                step => from[operands(step).next().expect("an operand")],
            };
            from.push(own);
        }
        (0..steps.len()).filter(|k| matches!(steps[*k], Step::Packed(..))).map(|k| from[k]).collect()
    }

    #[test]
    fn chains_that_wait_are_taken_in_turns() {
        let (before, after) = (chains(3, 4), ordered(chains(3, 4), Vectors::Eight));
        assert_eq!(order(&before), [0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2]);
        assert_eq!(order(&after), [0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2]);
        assert_eq!(after.iter().filter(|step| is_store(**step)).count(), 3);
    }

    /// Of more chains than there are registers, no more are begun than registers last; what nothing uses is left out.
    #[test]
    fn values_stay_in_registers() {
        for (vectors, registers) in [(Vectors::Four, 16), (Vectors::Eight, 32)] {
            let mut steps = chains(50, 6);
            steps.push(Step::Packed(Packed::Add, 0, 0));
            let after = ordered(steps.clone(), vectors);
            assert_eq!(after.len(), steps.len() - 1);
            let (mut ends, mut live, mut most) = (vec![0; after.len()], 0_i32, 0);
            for (k, step) in after.iter().enumerate() {
                operands(*step).for_each(|operand| ends[operand] = k);
            }
            for (k, step) in after.iter().enumerate().filter(|(_, step)| !is_read(**step)) {
                let used: Vec<usize> = operands(*step).filter(|value| !is_read(after[*value])).collect();
                live += i32::from(!is_store(*step)) - used.iter().filter(|value| ends[**value] == k).count() as i32;
                most = most.max(live);
            }
            assert!(most <= registers && most > 4, "{most} of {registers}");
        }
    }
}
