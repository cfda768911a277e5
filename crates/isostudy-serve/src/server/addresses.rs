//! What one address may ask of the server in a time. Addresses are kept in memory for as long as they count, a minute or two,
//! and are never written anywhere.

use axum::http::HeaderMap;
use std::collections::HashMap;
use std::net::{IpAddr, Ipv6Addr};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Addresses that are looked through for some that no longer count.
const MANY: usize = 1024;

/// Where a request comes from, as the socket says.
#[derive(Debug, Clone, Copy)]
pub(super) struct Peer(pub(super) IpAddr);

/// Whoever asked. A server with a public address has a proxy on the same machine in front of it, which adds the address of its
/// client to those in `X-Forwarded-For`; what a client has put there itself comes before that.
pub(super) fn client(Peer(peer): Peer, headers: &HeaderMap, behind_proxy: bool) -> IpAddr {
    let told = || {
        let last = headers.get_all("x-forwarded-for").iter().next_back()?;
        last.to_str().ok()?.rsplit(',').next()?.trim().parse::<IpAddr>().ok()
    };
    let peer = peer.to_canonical();
    let proxied = behind_proxy && peer.is_loopback();
    proxied.then(told).flatten().map_or(peer, |address| address.to_canonical())
}

/// What counts as one address: of IPv6 the 64 bits that one household or one machine is given whole.
pub(super) fn network(address: IpAddr) -> IpAddr {
    match address.to_canonical() {
        IpAddr::V6(address) => IpAddr::V6(Ipv6Addr::from_bits(address.to_bits() >> 64 << 64)),
        address => address,
    }
}

/// A budget for each address: so much at once, which comes back evenly.
pub(super) struct Budgets {
    most: f64,
    per_second: f64,
    all: Mutex<Accounts>,
}

#[derive(Default)]
struct Accounts {
    of: HashMap<IpAddr, (f64, Instant)>,
    /// When there are so many, those that are full are forgotten.
    look_at: usize,
}

impl Budgets {
    /// `most` at once, all of which are back after `back_in`.
    pub(super) fn new(most: u32, back_in: Duration) -> Self {
        let most = f64::from(most);
        Self { most, per_second: most / back_in.as_secs_f64(), all: Mutex::default() }
    }

    /// Takes one, at most `ahead` of those that are still to come back.
    ///
    /// Returns how long to wait for it.
    ///
    /// # Errors
    /// How long until one can be taken.
    pub(super) fn take(&self, address: IpAddr, ahead: u32, now: Instant) -> Result<Duration, Duration> {
        let mut all = self.all.lock().expect("nothing panics with it");
        if all.of.len() >= all.look_at.max(MANY) {
            let full = |&(left, then): &(f64, Instant)| self.left(left, then, now) >= self.most;
            all.of.retain(|_, account| !full(account));
            all.look_at = 2 * all.of.len();
        }
        let account = all.of.entry(network(address)).or_insert((self.most, now));
        let left = self.left(account.0, account.1, now) - 1.0;
        let lacking = -f64::from(ahead) - left;
        if lacking > 1e-9 {
            return Err(Duration::from_secs_f64(lacking / self.per_second));
        }
        *account = (left, now);
        Ok(Duration::from_secs_f64((-left / self.per_second).max(0.0)))
    }

    fn left(&self, left: f64, then: Instant, now: Instant) -> f64 {
        let back = now.saturating_duration_since(then).as_secs_f64() * self.per_second;
        (left + back).min(self.most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: IpAddr = IpAddr::V4(std::net::Ipv4Addr::new(203, 0, 113, 7));
    const B: IpAddr = IpAddr::V4(std::net::Ipv4Addr::new(203, 0, 113, 8));

    #[test]
    fn a_budget_is_spent_and_comes_back() {
        let budgets = Budgets::new(10, Duration::from_secs(5));
        let start = Instant::now();
        let after = |seconds: f64| start + Duration::from_secs_f64(seconds);
        assert!((0..10).all(|_| budgets.take(A, 0, start) == Ok(Duration::ZERO)));
        assert_eq!(budgets.take(A, 0, start), Err(Duration::from_secs_f64(0.5)));
        assert_eq!(budgets.take(B, 0, start), Ok(Duration::ZERO), "another address has its own");
        // Two a second come back.
        assert!(budgets.take(A, 0, after(0.4)).is_err());
        assert!((0..2).all(|_| budgets.take(A, 0, after(1.0)).is_ok()));
        assert!(budgets.take(A, 0, after(1.0)).is_err());
        // Never more than at first.
        assert!((0..10).all(|_| budgets.take(A, 0, after(1000.0)).is_ok()));
        assert!(budgets.take(A, 0, after(1000.0)).is_err());
    }

    #[test]
    fn what_is_to_come_back_can_be_waited_for() {
        let budgets = Budgets::new(2, Duration::from_secs(1));
        let now = Instant::now();
        let waits: Vec<_> = (0..5).map(|_| budgets.take(A, 3, now)).collect();
        assert_eq!(waits, [0.0, 0.0, 0.5, 1.0, 1.5].map(|seconds| Ok(Duration::from_secs_f64(seconds))));
        assert_eq!(budgets.take(A, 3, now), Err(Duration::from_secs_f64(0.5)));
    }

    #[test]
    fn addresses_that_no_longer_count_are_forgotten() {
        let budgets = Budgets::new(1, Duration::from_secs(1));
        let start = Instant::now();
        for number in 0..100_000_u32 {
            let now = start + Duration::from_millis(u64::from(number));
            budgets.take(IpAddr::from(number.to_be_bytes()), 0, now).unwrap();
        }
        // A thousand come in the second for which one counts.
        assert!(budgets.all.lock().unwrap().of.len() <= 2 * MANY + 2);
    }

    #[test]
    fn an_address_is_what_the_nearest_proxy_says() {
        let headers = |lines: &[&str]| {
            let mut headers = HeaderMap::new();
            for line in lines {
                headers.append("x-forwarded-for", line.parse().unwrap());
            }
            headers
        };
        let [near, far] = ["::ffff:127.0.0.1", "198.51.100.1"].map(|text| Peer(text.parse().unwrap()));
        let told = headers(&["10.9.9.9", "10.9.9.8, 203.0.113.7"]);
        assert_eq!(client(near, &told, true), A);
        let peer: IpAddr = "127.0.0.1".parse().unwrap();
        assert_eq!(client(near, &told, false), peer);
        assert_eq!(client(near, &headers(&["nobody"]), true), peer);
        assert_eq!(client(near, &headers(&[]), true), peer);
        assert_eq!(client(far, &told, true), far.0, "only this machine's proxy is believed");
        let one = |text: &str| network(text.parse().unwrap());
        assert_eq!(one("2001:db8:1:2:3:4:5:6"), one("2001:db8:1:2::9"));
        assert_ne!(one("2001:db8:1:2::9"), one("2001:db8:1:3::9"));
        assert_eq!(one("::ffff:203.0.113.7"), A);
    }
}
