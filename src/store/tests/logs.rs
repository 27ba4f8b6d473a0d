//! Logs: many writers, torn ends, damaged and deleted lines, older formats.

use super::*;
use proptest::prelude::*;

const LOG: &str = "turns";

fn path(store: &Store) -> PathBuf {
    store.dir().join("history/turns.jsonl")
}

fn read(store: &Store) -> Log<u32> {
    store.read_log(LOG).unwrap()
}

fn append(store: &Store, values: impl IntoIterator<Item = u32>) {
    values.into_iter().for_each(|value| store.lock().unwrap().append(LOG, &value).unwrap());
}

fn lines(store: &Store) -> Vec<Vec<u8>> {
    fs::read(path(store)).unwrap().split_inclusive(|byte| *byte == b'\n').map(<[u8]>::to_vec).collect()
}

#[test]
fn logs_survive_a_torn_line_and_many_writers() {
    let (_home, store) = store();
    assert_eq!(read(&store), Log { lines: vec![], damage: vec![], lost: 0, torn: false });
    let writers: Vec<_> = (0..4)
        .map(|writer| {
            let store = store.clone();
            std::thread::spawn(move || append(&store, (0..10).map(|line| writer * 10 + line)))
        })
        .collect();
    writers.into_iter().for_each(|writer| writer.join().unwrap());
    let log = read(&store);
    let mut values = log.lines;
    values.sort_unstable();
    assert_eq!((values, log.damage), ((0..40).collect(), vec![]));
    let whole = fs::read(path(&store)).unwrap();
    fs::write(path(&store), [whole.as_slice(), b"{\"ha"].concat()).unwrap();
    assert_eq!((read(&store).torn, read(&store).lines.len(), read(&store).lost), (true, 40, 0));
    append(&store, [40]);
    assert_eq!((read(&store).lines.len(), read(&store).torn, read(&store).damage.len()), (41, false, 0));
    assert!(store.lock().unwrap().append("../log", &1).is_err() && store.read_log::<u32>("../log").is_err());
}

#[test]
fn a_crash_between_a_line_and_its_head_is_no_damage() {
    let (_home, store) = store();
    append(&store, [1]);
    let head = fs::read(store.dir().join("history/turns.head")).unwrap();
    append(&store, [2]);
    fs::write(store.dir().join("history/turns.head"), head).unwrap();
    assert_eq!((read(&store).lines, read(&store).lost), (vec![1, 2], 0));
    append(&store, [3]);
    assert_eq!((read(&store).lines, read(&store).damage), (vec![1, 2, 3], vec![]));
}

#[test]
fn bare_lines_of_the_first_format_are_migrated_and_kept() {
    let home = tempfile::tempdir().unwrap();
    let dir = home.path().join(FOLDER);
    fs::create_dir_all(dir.join("history")).unwrap();
    fs::write(dir.join("format"), b"1\n").unwrap();
    let old = b"1\nnonsense\n2\n";
    fs::write(dir.join("history/turns.jsonl"), old).unwrap();
    let store = Store::open(&dir).unwrap();
    assert_eq!(fs::read(store.dir().join("backup/format-1/turns.jsonl")).unwrap(), old);
    assert_eq!((read(&store).lines, read(&store).damage.len()), (vec![1, 2], 1));
    append(&store, [3]);
    let store = Store::open(&dir).unwrap();
    assert!(store.id().is_some() && fs::read_to_string(dir.join("format")).unwrap() == "2\n");
    assert_eq!((read(&store).lines, read(&store).damage.len()), (vec![1, 2, 3], 1));
    assert!(lines(&store)[3].starts_with(b"{\"check\":"));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever happens to one line, all others are read, the damage is reported, lines can be added, and a repair
    /// leaves a log without damage and a copy of the old one.
    #[test]
    fn damage_to_a_line_costs_that_line(count in 1..8_usize, at in 0..8_usize, byte in 0..1000_usize, value: u8, harm in 0..3_u8) {
        let (_home, mut store) = store();
        append(&store, 0..count as u32);
        let at = at % count;
        let mut all = lines(&store);
        let byte = byte % (all[at].len() - 1);
        match harm {
            0 if all[at][byte] != value && value != b'\n' => all[at][byte] = value,
            1 => all[at] = b"nonsense\n".to_vec(),
            _ => drop(all.remove(at)),
        }
        fs::write(path(&store), all.concat()).unwrap();
        let sound = |until: usize| (0..until as u32).filter(|value| *value != at as u32).collect::<Vec<_>>();
        let log = read(&store);
        prop_assert_eq!(log.lines, sound(count));
        prop_assert!(log.lost >= 1 && !log.damage.is_empty());
        append(&store, [count as u32]);
        let log = read(&store);
        prop_assert_eq!(log.lines, sound(count + 1));
        prop_assert!(!log.damage.is_empty(), "the gap stays visible");
        let before = fs::read(path(&store)).unwrap();
        prop_assert!(!store.verify(false).unwrap().is_empty());
        prop_assert!(store.verify(true).unwrap().iter().all(|finding| finding.repair.is_some()));
        prop_assert_eq!(store.verify(false).unwrap(), vec![]);
        prop_assert_eq!(read(&store).lines, sound(count + 1));
        let backup = fs::read_dir(store.dir().join("backup")).unwrap().next().unwrap().unwrap().path().join("turns.jsonl");
        prop_assert_eq!(fs::read(backup).unwrap(), before);
    }
}
