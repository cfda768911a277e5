//! The connections that are open, and which of them ends where there are too many.

use super::addresses::network;
use super::pace::Pace;
use std::collections::HashMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

/// Who has taken nothing for so long, though something waits, goes first.
const STUCK: Duration = Duration::from_secs(2);

/// Connections, no more than a certain number at a time.
pub(super) struct Connections {
    places: Arc<Semaphore>,
    open: Mutex<Open>,
}

#[derive(Default)]
struct Open {
    next: u64,
    all: HashMap<u64, (IpAddr, Arc<Pace>)>,
}

/// The place of one connection, given back when dropped.
pub(super) struct Guest {
    number: u64,
    pub(super) pace: Arc<Pace>,
    connections: Arc<Connections>,
    _place: OwnedSemaphorePermit,
}

impl Drop for Guest {
    fn drop(&mut self) {
        self.connections.open.lock().expect("nothing panics with it").all.remove(&self.number);
    }
}

impl Connections {
    pub(super) fn new(most: usize) -> Arc<Self> {
        Arc::new(Self { places: Arc::new(Semaphore::new(most)), open: Mutex::default() })
    }

    /// A place for a client; where there is none, another connection ends for it.
    pub(super) async fn enter(self: &Arc<Self>, address: IpAddr) -> Guest {
        let place = match Arc::clone(&self.places).try_acquire_owned() {
            Ok(place) => place,
            Err(_) => {
                self.end_one();
                Arc::clone(&self.places).acquire_owned().await.expect("never closed")
            }
        };
        let pace = Arc::new(Pace::new());
        let mut open = self.open.lock().expect("nothing panics with it");
        let number = open.next;
        open.next += 1;
        open.all.insert(number, (network(address), Arc::clone(&pace)));
        Guest { number, pace, connections: Arc::clone(self), _place: place }
    }

    /// Ends the connection that can be missed best.
    pub(super) fn end_one(&self) {
        let mut open = self.open.lock().expect("nothing panics with it");
        let now = Instant::now();
        let all = open.all.iter().map(|(&number, (address, pace))| (number, *address, pace.last()));
        if let Some((_, pace)) = missed_best(all, now).and_then(|number| open.all.remove(&number)) {
            pace.cut.notify_one();
        }
    }
}

/// Of the address with most connections, so that nobody's are ended by somebody elsewhere: whichever is stuck, and else any, has
/// been silent longest.
fn missed_best(
    all: impl Iterator<Item = (u64, IpAddr, (Instant, bool))> + Clone,
    now: Instant,
) -> Option<u64> {
    let mut counts: HashMap<IpAddr, usize> = HashMap::new();
    all.clone().for_each(|(_, address, _)| *counts.entry(address).or_default() += 1);
    let (busiest, _) = counts.into_iter().max_by_key(|&(address, count)| (count, address))?;
    let stuck = |(moved, blocked): (Instant, bool)| blocked && now.saturating_duration_since(moved) > STUCK;
    all.filter(|(_, address, _)| *address == busiest)
        .min_by_key(|&(number, _, last)| (!stuck(last), last.0, number))
        .map(|(number, ..)| number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_holds_most_and_is_stuck_goes_first() {
        let now = Instant::now() + Duration::from_secs(100);
        let ago = |seconds| now - Duration::from_secs(seconds);
        let [a, b] = [1, 2].map(|last| IpAddr::from([10, 0, 0, last]));
        let mut all = vec![
            (1, a, (ago(90), true)),
            (2, b, (ago(9), false)),
            (3, b, (ago(5), true)),
            (4, b, (ago(6), false)),
            (5, b, (ago(1), true)),
        ];
        let mut order = Vec::new();
        while let Some(number) = missed_best(all.iter().copied(), now) {
            order.push(number);
            all.retain(|one| one.0 != number);
        }
        // Number 5 reads: it has waited for a moment. Of one connection each the later address goes first.
        assert_eq!(order, [3, 2, 4, 5, 1]);
        assert_eq!(missed_best([].into_iter(), now), None);
    }

    #[test]
    fn a_place_is_made_and_given_back() {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
        runtime.block_on(async {
            let connections = Connections::new(2);
            let address = IpAddr::from([127, 0, 0, 1]);
            let first = connections.enter(address).await;
            let second = connections.enter(address).await;
            let pace = Arc::clone(&first.pace);
            // As the task of the first connection does.
            let task = tokio::spawn(async move {
                pace.cut.notified().await;
                drop(first);
            });
            let third = connections.enter(address).await;
            task.await.unwrap();
            assert_eq!(connections.open.lock().unwrap().all.len(), 2);
            drop((second, third));
            assert!(connections.open.lock().unwrap().all.is_empty());
            assert_eq!(connections.places.available_permits(), 2);
        });
    }
}
