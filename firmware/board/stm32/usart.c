#include "board.h"
#include "interrupts.h"
#include "protocol.h"
#include "chip.h"
#include "wiring.h"

#define RX_ROOM 512u /* bytes; the law's step lasts 30 bytes of line time */
#define TX_ROOM 512u
_Static_assert((RX_ROOM & (RX_ROOM - 1u)) == 0u && (TX_ROOM & (TX_ROOM - 1u)) == 0u, "rings wrap by masking");
_Static_assert(TX_ROOM >= 2u * PROTOCOL_LINE_MAX, "a reply and a telemetry frame must fit");

/* One writer and one reader each: interrupt writes rx.head, main writes rx.tail, and the other way round for tx. */
static struct {
    uint8_t bytes[RX_ROOM];
    volatile uint32_t head;
    volatile uint32_t tail;
} rx;
static struct {
    uint8_t bytes[TX_ROOM];
    volatile uint32_t head;
    volatile uint32_t tail;
} tx;
static volatile uint32_t overruns, framing_errors, noise_errors, ring_overflows;
static uint32_t frames_dropped;

void USART2_Handler(void);

void usart_start(void)
{
    clock_to_line();
    pin_alternate(PORT_A, TRANSMIT_PIN, LINE_FUNCTION, false);
    pin_alternate(PORT_A, RECEIVE_PIN, LINE_FUNCTION, true); /* an open line reads as idle */
    USART2->BRR = (BOARD_CLOCK_HZ + PROTOCOL_BAUD_RATE / 2u) / PROTOCOL_BAUD_RATE;
    USART2->CR1 = USART_CR1_UE | USART_CR1_RE | USART_CR1_TE | USART_CR1_RXNEIE;
    interrupt_start(IRQ_USART2, PRIORITY_USART);
}

/* An error flag that stays set stops reception for good, so each is cleared where it is seen. */
static void clear_errors(uint32_t status)
{
    if ((status & (USART_ISR_ORE | USART_ISR_FE | USART_ISR_NE)) == 0u) {
        return;
    }
    overruns += (status & USART_ISR_ORE) != 0u ? 1u : 0u;
    framing_errors += (status & USART_ISR_FE) != 0u ? 1u : 0u;
    noise_errors += (status & USART_ISR_NE) != 0u ? 1u : 0u;
    USART2->ICR = USART_ICR_ORECF | USART_ICR_FECF | USART_ICR_NECF;
}

static void keep(uint8_t byte)
{
    const uint32_t head = rx.head;
    if (head - rx.tail >= RX_ROOM) {
        ring_overflows++;
        return;
    }
    rx.bytes[head & (RX_ROOM - 1u)] = byte;
    rx.head = head + 1u;
}

static void send_next(void)
{
    const uint32_t tail = tx.tail;
    if (tx.head - tail > TX_ROOM) {
        tx.tail = tx.head; /* an index is damaged */
    }
    if (tx.tail == tx.head) {
        USART2->CR1 &= ~USART_CR1_TXEIE;
        return;
    }
    USART2->TDR = tx.bytes[tail & (TX_ROOM - 1u)];
    tx.tail = tail + 1u;
}

void USART2_Handler(void)
{
    const uint32_t status = USART2->ISR;
    clear_errors(status);
    if ((status & USART_ISR_RXNE) != 0u) {
        keep((uint8_t)USART2->RDR);
    }
    if ((status & USART_ISR_TXE) != 0u && (USART2->CR1 & USART_CR1_TXEIE) != 0u) {
        send_next();
    }
}

bool usart_waiting(void)
{
    return rx.head != rx.tail;
}

bool usart_read(uint8_t *byte)
{
    const uint32_t tail = rx.tail;
    if (rx.head - tail > RX_ROOM) {
        rx.tail = rx.head; /* an index is damaged: empty is the only state that is known to be true */
        return false;
    }
    if (tail == rx.head) {
        return false;
    }
    *byte = rx.bytes[tail & (RX_ROOM - 1u)];
    rx.tail = tail + 1u;
    return true;
}

static void start_sending(uint32_t head)
{
    interrupts_off(); /* the handler clears the same register's bit */
    tx.head = head;
    USART2->CR1 |= USART_CR1_TXEIE;
    interrupts_on();
}

void usart_write(const uint8_t *line, size_t length)
{
    const uint32_t head = tx.head;
    const uint32_t waiting = head - tx.tail;
    if (length == 0u) {
        return;
    }
    if (waiting <= TX_ROOM && TX_ROOM - waiting < length) {
        frames_dropped++;
        start_sending(head); /* a ring that a damaged index makes full must still run empty */
        return;
    }
    for (uint32_t i = 0; i < length; i++) {
        tx.bytes[(head + i) & (TX_ROOM - 1u)] = line[i];
    }
    start_sending(head + (uint32_t)length);
}

void usart_faults(board_faults *faults)
{
    faults->uart_overruns = overruns;
    faults->uart_framing_errors = framing_errors;
    faults->uart_noise_errors = noise_errors;
    faults->rx_ring_overflows = ring_overflows;
    faults->tx_frames_dropped = frames_dropped;
}
