/* USART2 (RM0444 33): 8 data bits, no parity, one stop bit, without FIFO; and the host's end of the line. */
#include "exceptions.h"
#include "fault.h"
#include "peripherals.h"
#include "schedule.h"

enum { CR1 = 0x00, CR2 = 0x04, CR3 = 0x08, BRR = 0x0C, RQR = 0x18, ISR = 0x1C, ICR = 0x20, RDR = 0x24, TDR = 0x28, PRESC = 0x2C };
enum { UE = 1, RE = 4, TE = 8, RXNEIE = 0x20, TCIE = 0x40, TXEIE = 0x80, OVER8 = 0x8000 };
enum { EIE = 1, OVRDIS = 0x1000, ONEBIT = 0x800 };
enum { FE = 2, NE = 4, ORE = 8, RXNE = 0x20, TC = 0x40, TXE = 0x80, TEACK = 0x200000, REACK = 0x400000 };

/* What is modelled of the control registers; anything else stops the run. */
#define CR1_MODELLED (UE | RE | TE | RXNEIE | TCIE | TXEIE | OVER8)
#define CR3_MODELLED (EIE | OVRDIS | ONEBIT)
#define USART2_IRQ 28u
#define FRAME_BITS 10u

static const uint16_t PRESCALERS[] = {1, 2, 4, 6, 8, 10, 12, 16, 32, 64, 128, 256};

void usart_reset(machine *m) {
    m->device.usart = (usart_state){.isr = TC | TXE};
    m->device.due[DEV_USART_TX] = m->device.due[DEV_USART_RX] = NEVER;
}

/* Length of a bit from BRR and the clock; OVER8 keeps bits 2:0 of the divider shifted right by one (RM0444 33.5.8). */
static uint64_t bit_cycles(const machine *m) {
    const usart_state *u = &m->device.usart;
    uint64_t divider = u->cr1 & OVER8 ? ((u->brr & 0xFFF0u) | (u->brr & 7u) << 1) : u->brr & 0xFFFFu;
    uint64_t cycles = divider * PRESCALERS[u->presc] * m->device.clock.apb_divider;
    return u->cr1 & OVER8 ? cycles / 2 : cycles;
}

static uint64_t bit_ps(const machine *m) {
    const clock_state *clock = &m->device.clock;
    return time_of_cycle_ps(m, clock->base_cycle + bit_cycles(m)) - clock->base_ps;
}

static bool sends(const usart_state *u) { return (u->cr1 & (UE | TE)) == (UE | TE) && u->brr >= 16; }
static bool receives(const usart_state *u) { return (u->cr1 & (UE | RE)) == (UE | RE) && u->brr >= 16; }

static void update_line(machine *m) {
    const usart_state *u = &m->device.usart;
    bool data = u->cr1 & RXNEIE && u->isr & (RXNE | ORE);
    bool error = u->cr3 & EIE && u->isr & (FE | NE | ORE);
    bool sending = (u->cr1 & TXEIE && u->isr & TXE) || (u->cr1 & TCIE && u->isr & TC);
    interrupt_line(m, USART2_IRQ, u->cr1 & UE && (data || error || sending));
}

/* Move the byte from TDR to the shift register; TDR is empty at once. */
static void start_sending(machine *m) {
    usart_state *u = &m->device.usart;
    u->shifting = true;
    u->isr = (u->isr | TXE) & ~(uint32_t)TC;
    line_send(m->device.host.to_host, (uint8_t)u->tdr, now_ps(m), bit_ps(m));
    schedule(m, DEV_USART_TX, m->core.now + FRAME_BITS * bit_cycles(m));
    host_listen(m);
}

void usart_sent(machine *m) {
    usart_state *u = &m->device.usart;
    u->shifting = false;
    if (!(u->isr & TXE) && sends(u))
        start_sending(m);
    else
        u->isr |= TC;
    update_line(m);
}

static void listen(machine *m) {
    usart_state *u = &m->device.usart;
    if (!receives(u)) return schedule(m, DEV_USART_RX, NEVER);
    if (!u->rx.busy) u->rx.busy = receiver_find_start(&u->rx, m->device.host.to_board);
    if (u->rx.busy) schedule_ps(m, DEV_USART_RX, u->rx.edge_ps + FRAME_BITS * bit_ps(m));
}

/* RM0444 33.5.6: with RXNE still set the new byte is lost and ORE tells so; RDR keeps the old one. */
static void take_byte(usart_state *u, sampled_byte got) {
    if (u->isr & RXNE && !(u->cr3 & OVRDIS)) {
        u->isr |= ORE;
        return;
    }
    u->rdr = got.byte;
    u->isr |= RXNE | (got.framing_error ? FE : 0) | (got.noise && !(u->cr3 & ONEBIT) ? NE : 0);
}

void usart_received(machine *m) {
    usart_state *u = &m->device.usart;
    sampled_byte got = receiver_sample(&u->rx, m->device.host.to_board, bit_ps(m));
    u->rx.busy = false;
    if (!got.false_start) take_byte(u, got);
    update_line(m);
    listen(m);
}

void usart_line_changed(machine *m) { listen(m); }

void usart_reschedule(machine *m) {
    if (m->device.usart.rx.busy) listen(m);
    host_listen(m);
}

bool usart_read(machine *m, uint32_t index, uint32_t offset, uint32_t *value) {
    (void)index;
    usart_state *u = &m->device.usart;
    uint32_t acknowledge = (u->cr1 & UE) ? (u->cr1 & TE ? TEACK : 0) | (u->cr1 & RE ? REACK : 0) : 0;
    switch (offset) {
    case CR1: *value = u->cr1; break;
    case CR2: *value = u->cr2; break;
    case CR3: *value = u->cr3; break;
    case BRR: *value = u->brr; break;
    case ISR: *value = u->isr | acknowledge; break;
    case RDR: *value = u->rdr, u->isr &= ~(uint32_t)RXNE; break;
    case TDR: *value = u->tdr; break;
    case PRESC: *value = u->presc; break;
    default: *value = 0; break;
    }
    update_line(m);
    return true;
}

static bool set_control(machine *m, uint32_t cr1) {
    usart_state *u = &m->device.usart;
    bool heard_before = receives(u);
    if (cr1 & ~(uint32_t)CR1_MODELLED) return false;
    u->cr1 = cr1;
    if (!receives(u) || !heard_before) u->rx = (receiver){.search_ps = now_ps(m)};
    if (!(cr1 & UE)) u->isr = TC | TXE;
    listen(m);
    return true;
}

static void put(machine *m, uint32_t value) {
    usart_state *u = &m->device.usart;
    u->tdr = value & 0xFFu;
    u->isr &= ~(uint32_t)TXE;
    if (sends(u) && !u->shifting) start_sending(m);
}

static void request(usart_state *u, uint32_t value) {
    if (value & 8u) u->isr &= ~(uint32_t)RXNE; /* RXFRQ: drop the received byte */
}

bool usart_write(machine *m, uint32_t index, uint32_t offset, uint32_t value) {
    (void)index;
    usart_state *u = &m->device.usart;
    bool known = true;
    switch (offset) {
    case CR1: known = set_control(m, value); break;
    case CR2: known = value == 0, u->cr2 = value; break;
    case CR3: known = !(value & ~(uint32_t)CR3_MODELLED), u->cr3 = value; break;
    case BRR: u->brr = value & 0xFFFFu; break;
    case RQR: request(u, value); break;
    case ICR: u->isr &= ~(value & (FE | NE | ORE | TC)); break;
    case TDR: put(m, value); break;
    case PRESC: known = value < sizeof PRESCALERS / sizeof PRESCALERS[0], u->presc = known ? value : 0; break;
    default: known = offset == ISR || offset == RDR; break;
    }
    update_line(m);
    return known;
}

void host_send(machine *m, uint8_t byte, uint64_t earliest_ps) {
    uint64_t now = now_ps(m);
    line_send(m->device.host.to_board, byte, earliest_ps > now ? earliest_ps : now, m->device.host.bit_ps);
    listen(m);
}

void host_listen(machine *m) {
    host_side *host = &m->device.host;
    if (!host->rx.busy) host->rx.busy = receiver_find_start(&host->rx, host->to_host);
    if (host->rx.busy) schedule_ps(m, DEV_HOST_RX, host->rx.edge_ps + FRAME_BITS * host->bit_ps);
}

void host_received(machine *m) {
    host_side *host = &m->device.host;
    uint64_t end_ps = host->rx.edge_ps + FRAME_BITS * host->bit_ps;
    sampled_byte got = receiver_sample(&host->rx, host->to_host, host->bit_ps);
    host->rx.busy = false;
    if (!got.false_start) inbox_put(host->inbox, (received_byte){end_ps, got.byte, got.framing_error, got.noise});
    if (inbox_count(host->inbox) >= m->host_bytes_wanted) stop_run(m, STOP_HOST_BYTES, 0, 0);
    host_listen(m);
}
